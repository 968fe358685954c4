#!/usr/bin/env bash
# AddressSanitizer, with its leak checker, over the tests of all unsafe code: the C and Rust sides of
# the seam to Embree, the native kernel, and the stages on vector instructions.
#
#   scripts/asan.sh [ARGUMENT ...]     arguments go to the test programs: names, --nocapture, ...
#
# Works with a stable compiler: the sanitizer's flag is unlocked by RUSTC_BOOTSTRAP, and the standard
# library stays as it is, uninstrumented. Everything else is built anew, into target/asan.
set -euo pipefail
# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"
find_rust
cd "$repository"

target=$("$RUSTC" -vV | sed -n 's/^host: //p')
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}/asan
export RUSTC_BOOTSTRAP=1
# Only what is built for `--target` gets these flags: build scripts and macros run without.
export RUSTFLAGS='-Zsanitizer=address -Cforce-frame-pointers=yes'
export "CFLAGS_${target//-/_}=-fsanitize=address -fno-omit-frame-pointer -g"
export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1:halt_on_error=1

run_tests() {
    "$cargo" test --release --target "$target" "$@"
}

# The tests under valgrind are left out: one checker at a time.
run_tests --lib -- accel:: math:: geometry:: integrator:: "$@"
run_tests --test intersectors -- --skip valgrind "$@"
run_tests --test transport -- lanes:: reproducible:: "$@"
