# SPDX-License-Identifier: BSD-3-Clause
"""Files of tables and sites, and pages of HTML that need no internet."""
from __future__ import annotations

import base64
import csv
import io
import math
import pathlib
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence

import numpy as np

from .._cloud import add_array, vertices
from .._disk import write_whole
from .._files import read_regular, save
from .._pipeline import Error
from .._ranks import as_json
from .._writers import as_csv
from ._geojson import to_geodetic


def csv_rows(file, text: str, delimiter: str = ",") -> Iterator[List[str]]:
    """Rows of CSV. `Error` names the line in which a row begins that has a wrong quote, such as one that is not
    closed and would take the following rows into its cell."""
    rows, begin = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True, strict=True), 1
    try:
        for row in rows:
            yield row
            begin = rows.line_num + 1
    except csv.Error as error:
        raise Error(f"{file}: line {begin}: is not CSV ({error}), expected each quote to be closed") from None


def read_table(file, columns: Sequence[str] = (), expected: str = "") -> List[Dict[str, str]]:
    """Rows of CSV by the names of the columns. @param columns required @param expected what the file should be"""
    try:
        text = read_regular(file).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise Error(f"{file}: is not text in UTF-8 ({error})") from None
    rows = [row for row in csv_rows(file, text) if row]
    names = rows[0] if rows else []
    missing = [name for name in columns if name not in names]
    if missing:
        raise Error(f"{file}: has no column {missing[0]}, expected {expected}")
    return [{**dict.fromkeys(names, ""), **dict(zip(names, row))} for row in rows[1:]]


def write_table(file, rows: Sequence[Dict[str, Any]]) -> None:
    """Writes rows as CSV, with units in the header."""
    head = [[f"{name} [m]" if name in ("height_from", "height_to") else name for name in rows[0]]] if rows else []
    table = [[f"{value:.6g}" if isinstance(value, float) else value for value in row.values()] for row in rows]
    write_whole(file, as_csv(head + table, "\r\n"))


def texts(row: Iterable[Any]) -> List[Any]:
    """A row of CSV: numbers with six digits, nothing for None and nan."""
    def text(value: Any) -> Any:
        if value is None or value != value:
            return ""
        return f"{value:.6g}" if isinstance(value, float) else value
    return [text(value) for value in row]


def write_sites(folder, sites, columns: Mapping[str, Any], origin: Optional[Sequence[float]] = None,
                description: str = "") -> None:
    """Writes sites.csv and sites.vtp, and sites.geojson if the scene has an origin: one point for each site, in the
    given order.

    sites        n x 3, m
    columns      numbers by name, n each
    origin       latitude, longitude (deg), height (m) of the scene's origin
    description  description in sites.geojson
    """
    out, data = pathlib.Path(folder), vertices(sites)
    degrees = to_geodetic(sites, origin) if origin is not None else np.empty((0, 3))
    in_degrees = {} if origin is None else {"longitude": degrees[:, 0], "latitude": degrees[:, 1]}
    for name, values in {**columns, **in_degrees}.items():
        if len(values) != len(sites):
            raise ValueError(f"column {name!r} has {len(values)} values, expected {len(sites)}, one for each site")
        add_array(data.GetPointData(), name, np.asarray(values))
    out.mkdir(parents=True, exist_ok=True)
    save(data, out / "sites.vtp")
    save(data, out / "sites.csv")
    if origin is None:
        return
    rows = zip(degrees.tolist(), *(np.asarray(values).tolist() for values in columns.values()))
    features = [{"type": "Feature", "properties": dict(zip(columns, row)), "geometry": {
        "type": "Point", "coordinates": [round(lon, 9), round(lat, 9), round(height, 4)]}}
        for (lon, lat, height), *row in rows]
    write_whole(out / "sites.geojson", as_json({
        "type": "FeatureCollection", "description": description, "features": features}))


def embedded(file: pathlib.Path) -> str:
    """A picture (PNG) as a source in a page."""
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


def render(template: str, **values: Any) -> bytes:
    """A page of HTML. @param template file in this folder @param values by name; filters begin with `filter_`"""
    import jinja2
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(pathlib.Path(__file__).parent), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.globals["zip"] = zip
    environment.filters["number"] = lambda value, form: "–" if math.isnan(value) else form % value
    for name in list(values):
        if name.startswith("filter_"):
            environment.filters[name.removeprefix("filter_")] = values.pop(name)
    return environment.get_template(template).render(**values).encode()
