#!/bin/sh
# Tests denoising with the real Intel Open Image Denoise, and measures what it gains: FLIP against
# 4096 samples, of 16 samples before and after, on five scenes.
#
#     scripts/try-denoise.sh           # tests, then measures
#     scripts/try-denoise.sh measure   # measures alone
#
# The library is the one of OIDN_DIR, or of the Python package pyoidn, which is installed into
# target/denoise. SIZE (320x240) and REFERENCE (4096 samples) make it faster. Pictures stay in
# target/denoise.
set -eu
cd "$(dirname "$0")/.."
work=target/denoise
mkdir -p "$work"
if [ -z "${OIDN_DIR:-}" ]; then
    python3 -m pip install --quiet --upgrade --no-deps --target "$work/python" pyoidn
    OIDN_DIR=$PWD/$work/python/pyoidn/oidn
fi
export OIDN_DIR

if [ "${1:-}" != measure ]; then
    cargo test --release --test cli -- denoise
    cargo test --release --test pictures -- denoising
fi
cargo build --release --quiet
photosphere=target/release/photosphere
"$photosphere" doctor | grep '^oidn'

size=${SIZE:-320x240}
reference=${REFERENCE:-4096}
flip() {
    "$photosphere" compare "$1" "$2" --layer beauty --metric flip --json |
        python3 -c 'import json, sys; print(json.load(sys.stdin)["layers"][0]["flip"])'
}
echo "FLIP against $reference samples, $size pixels, through the tone curve srgb"
printf '%-28s %10s %10s %8s\n' scene '16 samples' denoised ratio
results=$work/results.txt
: > "$results"
# The scene, and options of the noisy render. The mean of `paper` is that of `path`.
while read -r scene options; do
    name=$work/$(basename "$scene")
    if [ ! -e "$name-truth.exr" ]; then
        "$photosphere" render "scenes/$scene.toml" --size "$size" --spp "$reference" --seed 99 \
            --quiet -o "$name-truth.exr" < /dev/null
    fi
    # shellcheck disable=SC2086 # The options are words.
    "$photosphere" render "scenes/$scene.toml" $options --size "$size" --spp 16 --denoise \
        --quiet -o "$name.exr" -o "$name-denoised.pfm" -o "$name-denoised.png" < /dev/null
    "$photosphere" convert "$name.exr" -o "$name-16.png" --layer beauty
    before=$(flip "$name.exr" "$name-truth.exr")
    after=$(flip "$name-denoised.pfm" "$name-truth.exr")
    echo "$scene $before $after" >> "$results"
    tail -n 1 "$results" | awk '{ printf "%-28s %10.4f %10.4f %8.2f\n", $1, $2, $3, $3 / $2 }'
done << EOF
paper/fig2 --integrator paper
cornell-spheres
smallpt
materials
many-lights
EOF
awk '$3 / $2 > worst { worst = $3 / $2 } END { print "worst ratio", worst; exit worst > 0.5 }' \
    "$results"
