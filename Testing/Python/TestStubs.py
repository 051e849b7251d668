# SPDX-License-Identifier: BSD-3-Clause
"""The type stubs have every class and method of the wrapped module. (TestTypes checks programs with them.)"""
import ast
import inspect
import pathlib
import unittest

import avianlidar
from avianlidar import vtkAvianLidar as wrapped

PACKAGE = pathlib.Path(avianlidar.__file__).parent


class Stubs(unittest.TestCase):
    def test_every_class_and_method(self):
        tree = ast.parse((PACKAGE / "vtkAvianLidar.pyi").read_text(encoding="utf-8"))
        written = {node.name: {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
                   for node in tree.body if isinstance(node, ast.ClassDef)}
        classes = {name: thing for name, thing in vars(wrapped).items() if inspect.isclass(thing)}
        self.assertEqual(set(written), set(classes))
        for name, thing in classes.items():
            methods = {key for key, value in vars(thing).items() if callable(value) and not inspect.isclass(value) and not key.startswith("_")}
            self.assertLessEqual(methods, written[name], name)
        self.assertTrue((PACKAGE / "py.typed").exists())


if __name__ == "__main__":
    unittest.main()
