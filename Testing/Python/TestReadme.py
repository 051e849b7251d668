# SPDX-License-Identifier: BSD-3-Clause
"""What the README and the page on Python show works: their Python runs as it stands; the README's commands
run in their order, in a clone of what is committed that has the build."""

import os
import pathlib
import re
import subprocess
import tempfile

import avianlidar

source = os.environ["AVIANLIDAR_SOURCE_DIR"]
with open(os.path.join(source, "README.md"), encoding="utf-8") as file:
    readme = file.read()


def run(page, text, names=()):
    """The blocks of one page follow one another; `names` are known to the first."""
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks, page
    names = {**dict(names), "__name__": page}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    return names


with open(os.path.join(source, "Documentation", "start", "python.md"), encoding="utf-8") as file:
    shown = run("python.md", file.read())
assert len(shown["energy"]) > 1400 and shown["scan"].attenuation_coefficient == 8.8e-5
assert shown["hit"].sum() > 10
os.remove("range.png")

shown = run("README.md", readme)
assert os.path.getsize("range.png") > 10000
with open("echoes.csv", encoding="utf-8") as file:
    assert file.readline().startswith("x [m],y [m],z [m],energy [J],")

assert avianlidar.load_cloud("echoes.vtp").units["energy"] == "J"

# Its commands, but for those that install or test, where the build has all that they need.
INSTALL_OR_TEST = ("CMake/install.sh", "Examples/paraview/run.sh", "Examples/airport/run.sh", "Testing/run.sh")
build = pathlib.Path(avianlidar.__file__).resolve().parents[4]
plugin = next(build.glob("lib/paraview-*/plugins/AvianLidarPlugin"))


def run_readme(tree):
    """Blocks of Python and of the shell, one after the other, and what is said in words: how to run the first."""
    (tree / "build").mkdir()
    (tree / "build" / "paraview").symlink_to(build)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["PATH"] = f"{build / 'bin'}:{environment['PATH']}"
    text = (tree / "README.md").read_text("utf-8")
    inline = re.search(r"`(PYTHONPATH=\$\(cat [^`]*) example.py`", text)[1]
    done, left = [], set(INSTALL_OR_TEST)
    for language, block in re.findall(r"```(\w+)\n(.*?)```", text, re.S):
        if language == "python":
            (tree / "example.py").write_text(block, "utf-8")
            commands = [f"{inline} example.py"]
        else:
            assert language == "sh", language
            commands = [line.split("  # ")[0].strip() for line in block.splitlines()]
        for command in commands:
            known = [one for one in INSTALL_OR_TEST if command.startswith(one)]
            if known:
                left.difference_update(known)
                assert os.access(tree / command, os.X_OK), command
                continue
            if command.startswith("avianlidar report"):
                command += " --siting-set spacing=1000 --siting-set draws=0"  # the same, of fewer candidates
            ended = subprocess.run(["bash", "-euc", command], cwd=tree, env=environment, capture_output=True, text=True,
                                   timeout=300, check=False)
            assert ended.returncode == 0, (command, ended.stderr[-2000:])
            done.append(command)
    assert not left, left
    return done


if plugin.exists() and (pathlib.Path(source) / ".git").exists():
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder) / "clone"
        subprocess.run(["git", "clone", "--quiet", source, tree], check=True)
        done = run_readme(tree)
        assert len(done) >= 6, done
        for name, least in (("echoes.csv", 10**5), ("range.png", 10**4), ("echoes.vtp", 10**5), ("echoes.las", 10**5),
                            ("maps/Search905/shares.csv", 100), ("report.html", 10**5), ("birds/manifest.json", 100)):
            assert (tree / name).stat().st_size > least, name
        assert len(list((tree / "birds").glob("sequences/*/labels/*.label"))) == 20
