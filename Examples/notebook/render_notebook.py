#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the notebook airport.ipynb, and writes the notebook with results as airport.html and each picture as <cell>.png.

    export PYTHONPATH=$(cat build/paraview/python-path)
    /usr/bin/python3 Examples/notebook/render_notebook.py --out build/notebook

The script needs python3-nbconvert and python3-ipykernel. A display or a network is not necessary.
"""
import argparse
import base64
import os
import pathlib
import tempfile

import nbformat
from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpecManager
from nbclient import NotebookClient
from nbconvert import HTMLExporter

HERE = pathlib.Path(__file__).resolve().parent


def execute(file):
    """The notebook with its results, run by this Python in an empty folder, like a copy."""
    notebook = nbformat.read(file, as_version=4)
    nbformat.validate(notebook)
    # Without kernel folders, the kernel is the kernel of this Python.
    kernel = AsyncKernelManager(kernel_name="python3", kernel_spec_manager=KernelSpecManager(kernel_dirs=[]))
    client = NotebookClient(notebook, km=kernel, timeout=300)
    client.owns_km = True  # so that the client ends the kernel
    os.environ.update(MPLBACKEND="module://matplotlib_inline.backend_inline",
                      PYDEVD_DISABLE_FILE_VALIDATION="1")  # without this variable the kernel's debugger prints warnings
    with tempfile.TemporaryDirectory() as folder:
        client.resources = {"metadata": {"path": folder}}
        client.execute()
    return notebook


def pictures(notebook):
    """{id of the cell: bytes of the PNG file that it shows last}."""
    return {cell.id: base64.b64decode(output.data["image/png"])
            for cell in notebook.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})}


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/notebook"),
                        help="folder of the results, default build/notebook")
    out = parser.parse_args(argv).out
    notebook = execute(HERE / "airport.ipynb")
    # Empty addresses, so that the page does not need a network.
    exporter = HTMLExporter(mathjax_url="", require_js_url="", jquery_url="")
    page, _ = exporter.from_notebook_node(notebook, resources={"metadata": {"name": "airport"}})
    out.mkdir(parents=True, exist_ok=True)
    (out / "airport.html").write_text(page, encoding="utf-8")
    for name, picture in pictures(notebook).items():
        (out / f"{name}.png").write_bytes(picture)
    return notebook


if __name__ == "__main__":
    main()
