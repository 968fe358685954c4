//! Where the command line is, which decides what it can advise.

/// What contains the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Packaging {
    /// An executable file of its own.
    #[default]
    Program,
    /// The Python package, which has no Embree.
    PythonPackage,
}
