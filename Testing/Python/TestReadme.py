# SPDX-License-Identifier: BSD-3-Clause
"""What the README and the pages on Python and on files show works: their Python runs as it stands, links lead somewhere."""

import os
import re

source = os.environ["AVIANLIDAR_SOURCE_DIR"]
with open(os.path.join(source, "README.md"), encoding="utf-8") as file:
    readme = file.read()

for target in re.findall(r"\]\(([^)#]+)\)", readme):
    if "://" not in target:
        assert os.path.exists(os.path.join(source, target)), f"README.md: no such file: {target}"


def run(page, text, names=()):
    """The blocks of one page follow one another; `names` are known to the first."""
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks, page
    names = {**dict(names), "__name__": page}
    for block in blocks:
        exec(compile(block.replace('"Examples/', f'"{source}/Examples/'), page, "exec"), names)
    return names


with open(os.path.join(source, "Documentation", "python.md"), encoding="utf-8") as file:
    shown = run("python.md", file.read())
assert len(shown["energy"]) > 1400 and shown["scan"].attenuation_coefficient == 8.8e-5
assert shown["hit"].sum() > 10


def rays(**settings):
    """Of the page's scan, and of the same in haze."""
    al = shown["al"]
    scan = al.Scan(al.load_scene(f"{source}/Examples/airport/scene/hongqiao.lidarscene.json"), shown["sensor"], **settings)
    counts = []
    for scan.attenuation_coefficient in (3.5e-5, 8.8e-5):
        scan.update()
        counts.append(scan.algorithm.GetNumberOfTracedRays())
    return counts


first, second = rays(rays_per_beam=400)
assert first > 0 and second == 0, (first, second)
first, second = rays(rays_per_beam=400, plane_integration=False)
assert round(100 * second / first) == 4, (first, second)
first, second = rays(preset="Standard", plane_integration=False)
assert round(100 * second / first) == 6, (first, second)
os.remove("range.png")

shown = run("README.md", readme)
assert os.path.getsize("range.png") > 10000
with open("echoes.csv", encoding="utf-8") as file:
    assert file.readline().startswith("x [m],y [m],z [m],energy [J],")

with open(os.path.join(source, "Documentation", "formats.md"), encoding="utf-8") as file:
    shown = run("formats.md", file.read(), shown)
assert shown["reader"].GetOutput().GetNumberOfPoints() == shown["echoes"].GetOutput().GetNumberOfPoints() > 1000
os.remove("echoes.las")

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

reader = vtkXMLPolyDataReader()
reader.SetFileName("echoes.vtp")
reader.Update()
cloud = reader.GetOutput()
assert cloud.GetNumberOfPoints() > 0
assert cloud.GetPointData().GetArray("energy") and cloud.GetPointData().GetArray("rgb")
