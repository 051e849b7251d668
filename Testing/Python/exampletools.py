# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the examples share: their modules, results as numpy arrays, and comparison of pictures."""
import os
import pathlib
import shutil
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: F401  # for the tests of the examples, as arrays

from cloudtools import field as strings  # noqa: F401
from echotools import arrays  # noqa: F401

SOURCE = os.environ["AVIANLIDAR_SOURCE_DIR"]
sys.path.append(os.path.join(SOURCE, "Documentation"))
import page_tables  # noqa: E402

EXAMPLES = os.path.join(SOURCE, "Examples")
OUTPUT = os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]
for home in (pathlib.Path(EXAMPLES), pathlib.Path(EXAMPLES).parent / "Testing" / "Studies"):
    sys.path[:0] = [str(folder) for folder in home.iterdir() if folder.is_dir()]


def emptied(*names):
    """A folder of that path, empty."""
    path = pathlib.Path(OUTPUT, *names)
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir(parents=True)
    return path


def folder(name):
    """The same as text, which arguments of examples are."""
    return str(emptied(name))


def number(data, name):
    return data.GetFieldData().GetArray(name).GetValue(0)


def read_table(file):
    """{column: {row: text}} of a Markdown table."""
    lines = pathlib.Path(file).read_text("utf-8").splitlines()
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    return {name: {row[0]: row[i + 1] for row in rows[2:]} for i, name in enumerate(rows[0][1:])}


def documented_table(name):
    """{column: {row: text}} of a table of Documentation/."""
    head, *rows = page_tables.rows(name)
    return {column: {row[0]: row[i + 1] for row in rows} for i, column in enumerate(head[1:])}


def assert_documented(test, table, name):
    """The counts of a table are those of the documentation. Another processor may differ by a beam or two."""
    documented = documented_table(name)
    test.assertEqual(list(table), list(documented))
    for column, rows in documented.items():
        for row, text in rows.items():
            if text.isdigit():
                found, wanted = int(table[column][row]), int(text)
                test.assertAlmostEqual(found, wanted, delta=2 + 0.003 * wanted, msg=(column, row))


def expected_energy(found, pulse_energy, attenuation):
    """Direct echo of a surface of one of the paper's materials (Table 1, Eq. 5-9)."""
    material = found["material_id"]
    table = np.array([(0.146, 0.054, 112), (0.020, 0.852, 8046), (0.075, 0.634, 6803), (0.107, 0.100, 82)])
    kd, ks, kp = table[material].T
    incidence = np.radians(found["incidence_angle"])
    reflected = kd * np.cos(incidence) + ks * np.maximum(0, np.cos(2 * incidence)) ** kp
    return pulse_energy * reflected * np.exp(-2 * attenuation * found["distance_m"])
