# SPDX-License-Identifier: Apache-2.0
# Sourced: `node_modules SOURCE FOLDER` copies the front end into FOLDER and installs its packages there, or skips.
node_modules() {
  for program in node npm; do
    command -v $program >/dev/null 2>&1 || { echo "skipped: there is no $program on this machine (scripts/setup test-full)"; exit 77; }
  done
  mkdir -p "$2" && rm -rf "$2/page" "$2/bundle" && cp -R "$1"/report/page "$1"/report/bundle "$1"/report/*.json "$1"/report/build.mjs "$2" || exit 1
  if ! cmp -s "$2/package-lock.json" "$2/node_modules/installed.json"; then
    # --ignore-scripts: esbuild's binary is a package of its own.
    (cd "$2" && npm ci --ignore-scripts --no-audit --no-fund) >"$2/npm.log" 2>&1 || {
      tail -3 "$2/npm.log"
      echo "skipped: npm could not install the packages of report/package-lock.json"
      exit 77
    }
    cp "$2/package-lock.json" "$2/node_modules/installed.json"
  fi
}
