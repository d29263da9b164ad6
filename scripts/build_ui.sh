#!/usr/bin/env bash
# Builds the page of `schuler ui` for the build of the program.
#
#   scripts/build_ui.sh AUTO|ON|OFF FOLDER     writes FOLDER/dist and then FOLDER/built
#
# AUTO: where npm is missing or reaches no registry, dist holds a page that says so, and the program is built all the same; the next
# build tries again once ui/ has changed or FOLDER/built is removed. ON makes that an error. OFF always makes that page. The packages
# are those of ui/package-lock.json, kept in FOLDER/node_modules; their install scripts are not run.
set -euo pipefail
mode=$1 folder=$2
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
mkdir -p "$folder"
rm -rf "$folder/dist" "$folder/built"

without_page() {
    if [ "$mode" = ON ]; then
        echo "build_ui: $1" >&2
        exit 1
    fi
    [ "$mode" = OFF ] || echo "build_ui: the page of \`schuler ui\` is left out: $1" >&2
    mkdir -p "$folder/dist"
    cat >"$folder/dist/index.html" <<HTML
<!doctype html><html lang="en"><meta charset="utf-8"><title>Schuler</title>
<body style="font:1rem sans-serif;max-width:40rem;margin:4rem auto">
<h1>Schuler</h1><p>This program was built without its page: $1.</p>
<p>The server and its API (<a href="/api/openapi.json">/api/openapi.json</a>) work. To have the page: make npm and its registry
reachable, remove <code>ui/built</code> from the build folder and build again.</p></body></html>
HTML
    echo without >"$folder/built"
    exit 0
}

[ "$mode" != OFF ] || without_page "the build was asked to leave it out"
command -v node >/dev/null && command -v npm >/dev/null || without_page "there is no npm"
[ "$(node -p 'process.versions.node.split(".")[0]')" -ge 18 ] || without_page "Node is older than 18"

# Work beside the sources, not in them: two builds may run at a time.
rm -rf "$folder/src"
mkdir -p "$folder/src"
for part in index.html package.json package-lock.json vite.config.ts tsconfig.json src public; do
    [ ! -e "$root/ui/$part" ] || cp -r "$root/ui/$part" "$folder/src/"
done
sum=$(sha256sum <"$root/ui/package-lock.json")
if [ "$(cat "$folder/packages" 2>/dev/null)" != "$sum" ]; then
    rm -rf "$folder/node_modules" "$folder/packages"
    (cd "$folder/src" && timeout 300 npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000) \
        >"$folder/npm.log" 2>&1 || without_page "npm could not install the packages of ui/package-lock.json (see ui/npm.log in the build folder)"
    mv "$folder/src/node_modules" "$folder/node_modules"
    echo "$sum" >"$folder/packages"
fi
ln -sfn "$folder/node_modules" "$folder/src/node_modules"
(cd "$folder/src" && node_modules/.bin/vite build --outDir "$folder/dist" --emptyOutDir --logLevel warn) >"$folder/vite.log" 2>&1 || {
    cat "$folder/vite.log" >&2
    exit 1
}
echo with >"$folder/built"
