# SPDX-License-Identifier: BSD-3-Clause
"""What the README shows works: its Python runs as it stands, its links lead somewhere."""

import os
import re

source = os.environ["AVIANLIDAR_SOURCE_DIR"]
with open(os.path.join(source, "README.md"), encoding="utf-8") as file:
    readme = file.read()

for target in re.findall(r"\]\(([^)#]+)\)", readme):
    if "://" not in target:
        assert os.path.exists(os.path.join(source, target)), f"README.md: no such file: {target}"

blocks = re.findall(r"```python\n(.*?)```", readme, re.S)
assert blocks
for block in blocks:
    exec(compile(block.replace('"Examples/', f'"{source}/Examples/'), "README.md", "exec"), globals())

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

reader = vtkXMLPolyDataReader()
reader.SetFileName("echoes.vtp")
reader.Update()
cloud = reader.GetOutput()
assert cloud.GetNumberOfPoints() > 0
assert cloud.GetPointData().GetArray("energy") and cloud.GetPointData().GetArray("rgb")
