#!/usr/bin/env bash
# Builds the page of `schuler ui` from ui/. What comes out is kept in ui/bundle, from where the build of the program takes it, so that
# only who changes the page needs Node.
#
#   scripts/build_ui.sh FOLDER             builds the page into FOLDER/dist
#   scripts/build_ui.sh FOLDER --update    and puts it into ui/bundle
#   scripts/build_ui.sh FOLDER --check     and compares it with ui/bundle byte by byte; exit status 1 when they differ
#
# Exit status 1 also when the types do not fit (where TypeScript is installed) or the page has 400 KiB or more compressed.
# Exit status 77 when Node 18 or npm is missing or npm reaches no registry. The packages are those of ui/package-lock.json, kept in
# FOLDER/node_modules; their install scripts are not run. The same sources and the same lock give the same bytes.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
[ $# -ge 1 ] || { sed -n 's/^# \{0,1\}//; 2,11p' "$0" >&2; exit 2; }
mkdir -p "$1"
folder=$(cd "$1" && pwd) mode=${2:-}

cannot() {
    echo "SKIPPED: $1"
    exit 77
}
command -v node >/dev/null && command -v npm >/dev/null || cannot "there is no npm"
[ "$(node -p 'process.versions.node.split(".")[0]')" -ge 18 ] || cannot "Node is older than 18"

# Work beside the sources, not in them: two builds may run at a time.
rm -rf "$folder/dist" "$folder/src"
mkdir -p "$folder/src"
for part in index.html package.json package-lock.json vite.config.ts tsconfig.json src public; do
    cp -r "$root/ui/$part" "$folder/src/"
done
sum=$(sha256sum <"$root/ui/package-lock.json")
if [ "$(cat "$folder/packages" 2>/dev/null)" != "$sum" ]; then
    rm -rf "$folder/node_modules" "$folder/packages"
    (cd "$folder/src" && timeout 300 npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000) \
        >"$folder/npm.log" 2>&1 || cannot "npm could not install the packages of ui/package-lock.json; $folder/npm.log says why"
    mv "$folder/src/node_modules" "$folder/node_modules"
    echo "$sum" >"$folder/packages"
fi
ln -sfn "$folder/node_modules" "$folder/src/node_modules"
# Vite removes the types without a look at them.
if [ -x "$folder/node_modules/.bin/tsc" ]; then
    (cd "$folder/src" && node_modules/.bin/tsc --noEmit) || { echo "the types of ui/ do not fit" >&2; exit 1; }
fi
(cd "$folder/src" && node_modules/.bin/vite build --outDir "$folder/dist" --emptyOutDir --logLevel warn) >"$folder/vite.log" 2>&1 || {
    cat "$folder/vite.log" >&2
    exit 1
}

# What a browser is sent the first time, or later for another language: each file compressed by itself.
limit_kib=400
bytes=$(find "$folder/dist" -type f -exec gzip -9nc {} + | wc -c)
[ "$bytes" -lt $((limit_kib * 1024)) ] || {
    echo "the page has $((bytes / 1024)) KiB compressed; $limit_kib are allowed" >&2
    exit 1
}

case "$mode" in
    "") ;;
    --update)
        rm -rf "$root/ui/bundle"
        cp -r "$folder/dist" "$root/ui/bundle"
        ;;
    --check)
        diff -rq "$root/ui/bundle" "$folder/dist" || {
            echo "ui/bundle is not what ui/ gives; scripts/build_ui.sh $folder --update renews it"
            exit 1
        }
        ;;
    *) echo "build_ui: unknown '$mode'" >&2; exit 2 ;;
esac
