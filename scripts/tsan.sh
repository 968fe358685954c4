#!/usr/bin/env bash
# ThreadSanitizer over the unit tests of what threads share: the film, and the job with its monitor,
# checkpoints and sessions.
#
#   scripts/tsan.sh [ARGUMENT ...]     arguments go to the test programs: names, --nocapture, ...
#
# The standard library must be instrumented, too, or each hand-over through a lock looks like a
# race. It is therefore built from source, which works with a stable compiler (RUSTC_BOOTSTRAP) and
# needs the component rust-src. Embree is left out: the sanitizer would not see its locks.
# Everything is built anew, into target/tsan.
set -euo pipefail
# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"
find_rust
cd "$repository"

if [[ ! -e $("$RUSTC" --print sysroot)/lib/rustlib/src/rust/library/Cargo.lock ]]; then
    echo 'The source of the standard library is missing: rustup component add rust-src' >&2
    exit 2
fi
target=$("$RUSTC" -vV | sed -n 's/^host: //p')
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}/tsan
export RUSTC_BOOTSTRAP=1
# The sanitizer knows no fences; with this flag, the deques of rayon do without.
export RUSTFLAGS='-Zsanitizer=thread --cfg crossbeam_sanitize_thread -Cforce-frame-pointers=yes'
export TSAN_OPTIONS=halt_on_error=0:second_deadlock_stack=1:history_size=4

# Optimised less: the instrumented library takes long to compile.
"$cargo" test -Zbuild-std --release --config profile.release.package.photosphere.opt-level=1 \
    --target "$target" --no-default-features --lib -- film:: job:: task:: "$@"
