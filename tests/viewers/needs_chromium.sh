# shellcheck shell=sh
# Sourced: exports CHROMIUM, or exits with 77 where the browser, node or playwright-core is missing. The browser is $CHROMIUM, else
# /usr/bin/chromium; the Node module playwright-core must be where NODE_PATH finds it.
: "${CHROMIUM:=/usr/bin/chromium}"
export CHROMIUM
[ -x "$CHROMIUM" ] || { echo "skipped: there is no $CHROMIUM"; exit 77; }
command -v node >/dev/null || { echo "skipped: there is no node"; exit 77; }
node -e 'require("playwright-core")' 2>/dev/null || { echo "skipped: node finds no playwright-core"; exit 77; }
