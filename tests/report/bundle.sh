#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: bundle.sh SOURCE DIR: the front end passes strict TypeScript, and its sources give the committed bundle.
set -u
. "$(dirname "$0")/node.sh"
node_modules "$1" "$2"
if grep -nE '"resolved"|https?://[^"]*registry' "$1/report/package-lock.json"; then
  echo "report/package-lock.json: names a registry; remove its \"resolved\" lines"
  exit 1
fi
cd "$2" || exit 1
node node_modules/typescript/bin/tsc --noEmit --strict -p . || exit 1
rm -rf again && node build.mjs again || exit 1
for file in page.js page.css; do
  cmp "again/$file" "$1/report/bundle/$file" || { echo "report/bundle/$file is not what report/page gives: make report-bundle"; exit 1; }
done
echo "bundle: $(cat again/page.js again/page.css | wc -c) bytes, as committed"
