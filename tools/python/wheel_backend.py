# Makes the wheel that pip installs (PEP 517): configures and builds Sinew with CMake and packs what its install rules
# give for the component `python`. Uses nothing but Python itself.
#
# Settings of pip (`--config-settings NAME=VALUE`): build-dir, a build folder to use instead of build/python-TAG.
# SPDX-License-Identifier: GPL-3.0-or-later
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"


def _version():
    found = re.search(r"project\(sinew VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())
    return found.group(1)


def _platform():
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")


def _metadata():
    return (
        "Metadata-Version: 2.1\nName: sinew\n"
        f"Version: {_version()}\n"
        "Summary: Soft tissue that moves by the laws of physics\n"
        "License: GPL-3.0-or-later\nRequires-Python: >=3.9\nRequires-Dist: numpy\n"
    )


def _jobs():
    """As many compilers as memory allows, 1.5 GB each."""
    available = 0
    for line in Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            available = int(line.split()[1]) // 1500000
    return max(1, min(os.cpu_count() or 1, available))


def _build(settings):
    """The build folder, with the module in it."""
    given = (settings or {}).get("build-dir")
    folder = Path(given).resolve() if given else ROOT / "build" / f"python-{TAG}"
    if not given:
        subprocess.run(
            ["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSINEW_TESTS=OFF",
             "-DSINEW_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}"],
            check=True,
        )
    subprocess.run(
        ["cmake", "--build", folder, "--target", "sinew_python", "--parallel", str(_jobs())], check=True
    )
    return folder


def _row(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = _build(config_settings)
    version = _version()
    info = f"sinew-{version}.dist-info"
    name = f"sinew-{version}-{TAG}-{TAG}-{_platform()}.whl"
    with tempfile.TemporaryDirectory() as prefix:
        subprocess.run(
            ["cmake", "--install", folder, "--component", "python", "--prefix", prefix], check=True,
            stdout=subprocess.DEVNULL,
        )
        package = next(Path(prefix).rglob("sinew/__init__.py")).parent
        files = {f"sinew/{path.relative_to(package)}": path.read_bytes() for path in sorted(package.rglob("*"))
                 if path.is_file()}
    files[f"{info}/METADATA"] = _metadata().encode()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: sinew\nRoot-Is-Purelib: false\nTag: {TAG}-{TAG}-{_platform()}\n"
    ).encode()
    record = "".join(_row(path, data) for path, data in files.items()) + f"{info}/RECORD,,\n"
    files[f"{info}/RECORD"] = record.encode()
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path)
            entry.external_attr = (0o755 if path.endswith(".so") else 0o644) << 16
            wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("Sinew is built from its repository: pip install ./tools/python")
