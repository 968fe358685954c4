//! Strips the extension module while it is linked: the profile keeps line tables, which are for
//! programs that are debugged, and another profile would compile the library once more.
fn main() {
    println!("cargo::rustc-cdylib-link-arg=-Wl,-s");
}
