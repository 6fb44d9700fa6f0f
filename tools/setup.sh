#!/bin/sh
# Make the virtual environment and see that the system libraries are there. Safe to run again.
set -eu
cd "$(dirname "$0")/.."

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"
    elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then sudo "$@"
    else return 1
    fi
}

install_packages() {
    echo "setup: installing system packages: $*"
    if command -v apt-get >/dev/null 2>&1; then
        export DEBIAN_FRONTEND=noninteractive
        as_root apt-get install -y -q "$@" >/dev/null 2>&1 && return 0
        as_root apt-get update -q >/dev/null 2>&1 && as_root apt-get install -y -q "$@" >/dev/null && return 0
    fi
    echo "setup: these system packages are missing and could not be installed here." >&2
    echo "setup: run this once, then the same make command again:" >&2
    echo "    sudo apt-get update && sudo apt-get install -y $*" >&2
    exit 1
}

PYTHON=${PYTHON:-python3}
command -v "$PYTHON" >/dev/null 2>&1 || install_packages python3 python3-venv
"$PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "setup: Python 3.11 or newer is needed; $PYTHON is $("$PYTHON" -V 2>&1). Set PYTHON=/path/to/python3.11" >&2
    exit 1
}
"$PYTHON" -c 'import ensurepip, venv' 2>/dev/null || install_packages python3-venv

# What the wheels of open3d and opencv open at run time, and the Debian package of each.
missing=
for pair in libusb-1.0.so.0=libusb-1.0-0 libGL.so.1=libgl1 libEGL.so.1=libegl1 \
            libX11.so.6=libx11-6 libgomp.so.1=libgomp1; do
    "$PYTHON" -c "import ctypes; ctypes.CDLL('${pair%%=*}')" 2>/dev/null || missing="$missing ${pair#*=}"
done
# shellcheck disable=SC2086
[ -z "$missing" ] || install_packages $missing

.venv/bin/python -m pip --version >/dev/null 2>&1 || "$PYTHON" -m venv --clear .venv
echo "setup: installing Python packages (about 1.5 GB, once)"
.venv/bin/python -m pip install -q --disable-pip-version-check -c constraints.txt \
    -e '.[sim,test,dev]'
touch .venv/.ready
