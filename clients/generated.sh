#!/bin/sh
# Generates a Python client of the interface's document, and imports every module of it. Packages
# are installed into a folder that is thrown away.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 -m venv "$work/python" &&
  "$work/python/bin/pip" install --quiet --disable-pip-version-check openapi-python-client==0.29.1 || {
  printf '\nSKIPPED: there is no Python with venv, or the generator cannot be installed\n'
  exit 0
}
# Media types that the generator does not know: bodies are files, other answers are texts.
cat > "$work/config.yaml" <<'YAML'
post_hooks: []
content_type_overrides:
  application/openmetrics-text: text/plain
  application/toml: text/plain
  application/vnd.openxmlformats-officedocument.spreadsheetml.sheet: application/octet-stream
  image/svg+xml: text/plain
  text/csv: application/octet-stream
  text/plain: application/octet-stream
  text/tab-separated-values: application/octet-stream
YAML
"$work/python/bin/openapi-python-client" generate --config "$work/config.yaml" --path "$here/../openapi.yaml" \
  --output-path "$work/servoscope_generated" --meta none --fail-on-warning
cd "$work"
python/bin/python - <<'PYTHON'
import importlib
import pkgutil

import servoscope_generated

modules = [module.name for module in pkgutil.walk_packages(servoscope_generated.__path__, "servoscope_generated.")]
for module in modules:
    importlib.import_module(module)
print(f"{len(modules)} modules of a generated client were imported")
PYTHON
