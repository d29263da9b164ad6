#!/usr/bin/env bash
# The embedded core (docs/embed.md) for this processor, for aarch64 and for arm: built, its example run (the last two under qemu), its
# results compared, its needs measured. The exit status is 0 only where all processors agree and nothing is allocated after construction.
#
#   scripts/embedded.sh [--count] [FOLDER [PROCESSOR...]]     folder of the builds: build-embedded; processors: native native-float32 aarch64 arm
#
# -float32 after a processor: with covariances in single precision. Compared with the first processor, whose precision is double.
# --count: instructions a sample as well, by the emulator's log of what it runs: some minutes more a processor.
# What it needs: scripts/packages.sh --install embedded
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
count=no
[ "${1:-}" != --count ] || { count=yes; shift; }
folder=$(realpath -m "${1:-$root/build-embedded}")
processors=("${@:2}")
[ ${#processors[@]} -gt 0 ] || processors=(native native-float32 aarch64 arm)

# Compiler, emulator and prefix of the tools of a processor.
choose() {
    case "${1%-float32}" in
        native) prefix='' emulator=(qemu-x86_64-static -cpu max) options=() ;;
        aarch64) prefix=aarch64-linux-gnu- emulator=(qemu-aarch64-static) options=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64) ;;
        arm) prefix=arm-linux-gnueabihf- emulator=(qemu-arm-static) options=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=arm) ;;
        *) echo "embedded: unknown processor '$1': native, aarch64 or arm" >&2; exit 2 ;;
    esac
    [[ "$1" != *-float32 ]] || options+=(-DSCHULER_FLOAT32_COVARIANCE=ON)
    [ -z "$prefix" ] || options+=("-DCMAKE_CXX_COMPILER=${prefix}g++")
    run=()
    [ "${1%-float32}" = native ] || run=("${emulator[@]}")
}

# Mean, median, 99.9 % and largest number of instructions between the example's marks, over the second half of a minute's drive. The
# emulator's log says which block of instructions is run, and when it translates a block, what is in it.
instructions() {
    "${emulator[@]}" -d in_asm,exec,nochain -D /dev/stderr "$1" 60 "$2" 2>&1 >/dev/null | awk '
        /^IN:/ { fresh = 1; next }
        /^0x/ {
            if ($0 ~ /^0x[0-9a-f]+: +([0-9a-f][0-9a-f] )*[0-9a-f][0-9a-f] *$/) next     # the rest of a long instruction
            if (fresh) { at = substr($1, 3); sub(/:$/, "", at); sub(/^0+/, "", at); size[at] = 0; fresh = 0 }
            ++size[at]
            next
        }
        $1 != "Trace" { next }
        $NF == "feed_begins" { n = 0; counting = 1; next }
        $NF == "feed_ends" { if (counting) all[++samples] = n; counting = 0; next }
        counting { split($4, part, "/"); sub(/^0+/, "", part[2]); n += size[part[2]] }
        END { for (i = int(samples / 2) + 1; i <= samples; ++i) print all[i] }' | sort -n | awk '
        { all[NR] = $1; sum += $1 }
        END { printf "%d calls: mean %d, median %d, 99.9 %% %d, largest %d\n", NR, sum / NR, all[int((NR + 1) / 2)], all[int(0.999 * NR)], all[NR] }'
}

for processor in "${processors[@]}"; do
    choose "$processor"
    build=$folder/$processor
    echo "== $processor"
    cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSCHULER_EMBEDDED=ON "${options[@]}" >/dev/null
    cmake --build "$build" >"$build/build.log" || { tail -n 30 "$build/build.log" >&2; exit 1; }
    "${run[@]}" "$build/embedded_drive" >"$build/drive.txt"
    echo "program, bytes of text, data, bss: $("${prefix}size" "$build/embedded_drive" | awk 'NR == 2 { print $1, $2, $3 }')"
    "${prefix}nm" -S -C "$build/embedded_drive" | python3 -c '
import sys
size = {}
for line in sys.stdin:
    word = line.split(None, 3)
    if len(word) == 4 and word[2] in "tTwWvVrR":
        owner = next((n for n in ("schuler", "fmt", "boost", "Eigen") if n + "::" in word[3]), "the rest and the C and C++ libraries")
        size[owner] = size.get(owner, 0) + int(word[1], 16)
print("of it code and constants of", ", ".join(f"{n} {b}" for n, b in sorted(size.items(), key=lambda x: x[1])))'
    echo "largest frames of the stack, bytes:"
    find "$build" -name '*.su' -exec cat {} + | awk -F'\t' '{ sub(/^.*src\/schuler\//, "", $1); print "  " $2 "  " substr($1, 1, 110) }' | sort -k1,1nr | sed -n 1,5p
    [ "$count" = no ] || for part in geographic ecef tight attitude; do
        echo "instructions, $part: $(instructions "$build/embedded_drive" "$part")"
    done
done

cd "$folder"
python3 - "${processors[@]}" <<'PYTHON'
import math
import sys

LARGEST, LARGEST_FLOAT32 = 1e-9, 1e-2      # of a sigma; of the sigma itself: relative

def rows(processor):
    with open(f"{processor}/drive.txt") as file:
        return [(w[0], *map(float, w[1:])) for w in map(str.split, file)]

def errors(a, b):
    """Largest difference of the state in sigmas and in its units, and of the sigmas relative to themselves."""
    if a[0] == "attitude":
        state, sigma = range(2, 5), range(5, 8)
    else:
        state, sigma = range(2, 11), range(11, 20)
    scale = {2: 6.4e6, 3: 6.4e6 * math.cos(a[2])} if a[0] != "attitude" else {}      # rad to m
    off = [abs(math.remainder(a[i] - b[i], 2 * math.pi) if i >= 8 or a[0] == "attitude" else a[i] - b[i]) * scale.get(i, 1.0) for i in state]
    in_sigmas = max(o / a[j] for o, j in zip(off, sigma))
    of_sigmas = max(abs(b[j] / a[j] - 1.0) for j in sigma)
    return in_sigmas, of_sigmas, max(off[:3]) if a[0] != "attitude" else 0.0

first, *others = sys.argv[1:]
good = True
for other in others:
    a, b = rows(first), rows(other)
    largest = LARGEST_FLOAT32 if "-float32" in first + other else LARGEST
    if not a or [r[:2] for r in a] != [r[:2] for r in b]:
        sys.exit(f"{first} and {other}: not the same rows")
    for kind in dict.fromkeys(r[0] for r in a):
        pairs = [errors(x, y) for x, y in zip(a, b) if x[0] == kind]
        state, sigma, metres = (max(p[i] for p in pairs) for i in range(3))
        print(f"{first} against {other}, {kind}, {len(pairs)} states: {state:.1e} of a sigma ({metres:.1e} m), sigmas {sigma:.1e} of themselves")
        good = good and max(state, sigma) <= largest
sys.exit(0 if good else f"the results differ by more than {LARGEST} (single precision: {LARGEST_FLOAT32})")
PYTHON
