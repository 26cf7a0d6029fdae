"""Runs a class of tests inside Debian's Blender, with the add-on installed from its zip as users do it.

run.py ZIP FILE CLASS. Ends with 77 where there is no Blender: ctest counts that as skipped."""
# SPDX-License-Identifier: GPL-3.0-or-later
import os
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77


def has_avx2():
    try:
        with open("/proc/cpuinfo") as file:
            return bool(re.search(r"^flags\b.*\bavx2\b", file.read(), re.M))
    except OSError:
        return False


def main():
    addon, file, name = sys.argv[1:]
    blender = os.environ.get("BLENDER") or shutil.which("blender")
    if blender is None:
        print("SKIPPED: Blender is not installed, so the add-on is not tested.")
        print("Debian: apt-get install --no-install-recommends blender")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="sinew_blender_") as home:
        env = dict(os.environ, HOME=home, BLENDER_USER_SCRIPTS=home + "/scripts", BLENDER_USER_CONFIG=home + "/config")
        env.update(SINEW_BLENDER_ZIP=os.path.abspath(addon), SINEW_TEST_CLASS=name, SINEW_TEST_FOLDER=home + "/work")
        # The program chooses kernels of its own where OpenBLAS does not know the processor, which a host cannot, and
        # frames are compared to the bit.
        if "OPENBLAS_CORETYPE" not in env and has_avx2():
            env["OPENBLAS_CORETYPE"] = "Haswell"
        os.makedirs(home + "/scripts/addons")
        os.makedirs(home + "/work")
        words = [blender, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3", "--python", file]
        done = subprocess.run(words, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(done.stdout)
    ran = re.search(r"^Ran ([1-9]\d*) tests?", done.stdout, re.M)
    return 0 if done.returncode == 0 and ran and re.search(r"^OK$", done.stdout, re.M) else 1


sys.exit(main())
