//! The `photosphere` program: everything is in the library, the printing is in `cli`.
fn main() -> std::process::ExitCode {
    photosphere::cli::main()
}
