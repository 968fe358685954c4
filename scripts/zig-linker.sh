#!/usr/bin/env bash
# Links against glibc 2.28, by zig: the linker of the wheel, whatever glibc this system has.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
exec "$here/../target/wheel-python/bin/python" -m ziglang cc -target x86_64-linux-gnu.2.28 "$@"
