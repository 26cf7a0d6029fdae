# The module as a package: what its stub says is what it has, and pip installs it.
# SPDX-License-Identifier: GPL-3.0-or-later
import ast
import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import sinew
from sinew import _sinew

SOURCE = Path(os.environ["SINEW_SOURCE_DIR"])
BUILD = os.environ["SINEW_BUILD_DIR"]


def public(names):
    kept = {"__init__", "__getitem__", "__contains__", "__len__", "__iter__"}
    return {name for name in names if not name.startswith("_") or name in kept}


class Stub(unittest.TestCase):
    def test_the_stub_names_what_the_module_has(self):
        tree = ast.parse((Path(sinew.__file__).parent / "_sinew.pyi").read_text())
        classes = {node.name: {f.name for f in node.body if isinstance(f, ast.FunctionDef)}
                   for node in tree.body if isinstance(node, ast.ClassDef)}
        found = {name: public(vars(thing)) for name, thing in vars(_sinew).items() if isinstance(thing, type)}
        for name in found:
            if "__init__" not in classes.get(name, ()):
                found[name].discard("__init__")
        self.assertEqual(classes, found)

    def test_the_package_says_what_it_has(self):
        for name in sinew.__all__:
            self.assertTrue(hasattr(sinew, name), name)
        self.assertTrue((Path(sinew.__file__).parent / "py.typed").exists())


class Wheel(unittest.TestCase):
    def test_pip_installs_it_without_network(self):
        with tempfile.TemporaryDirectory() as folder:
            made = subprocess.run(
                [sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--disable-pip-version-check",
                 "--target", folder, "--config-settings", f"build-dir={BUILD}", SOURCE / "tools/python"],
                capture_output=True, text=True, env={**os.environ, "PIP_BREAK_SYSTEM_PACKAGES": "1"},
            )
            self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
            environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
            said = subprocess.run(
                [sys.executable, "-c",
                 "import sinew; s = sinew.Session(text='{\"format\": \"sinew 1\", \"nodes\": {\"c\": {\"type\": "
                 "\"polyCube\"}}}'); print(sinew.__file__, sinew.__version__, s.evaluate(1, 'c.outMesh')[0].points.shape)"],
                capture_output=True, text=True, env={**environment, "PYTHONPATH": folder}, cwd=folder,
            )
            self.assertEqual(said.stdout, f"{folder}/sinew/__init__.py {sinew.__version__} (8, 3)\n", said.stderr)
            self.assertTrue(any(Path(folder).glob("sinew-*.dist-info/RECORD")))

    def test_the_wheel_has_the_package_and_nothing_else(self):
        sys.path.insert(0, str(SOURCE / "tools/python"))
        import wheel_backend

        with tempfile.TemporaryDirectory() as folder:
            name = wheel_backend.build_wheel(folder, {"build-dir": BUILD})
            with zipfile.ZipFile(Path(folder) / name) as wheel:
                names = wheel.namelist()
                record = wheel.read(names[-1]).decode()
        tops = {n.split("/")[0] for n in names}
        self.assertEqual(tops, {"sinew", f"sinew-{sinew.__version__}.dist-info"})
        self.assertEqual([row.split(",")[0] for row in record.splitlines()], names)
        self.assertEqual(sum(n.endswith(".so") for n in names), 1)
        self.assertIn("sinew/_sinew.pyi", names)


if __name__ == "__main__":
    unittest.main()
