# SPDX-License-Identifier: BSD-3-Clause
"""Writes the XML that ParaView reads, and the list of the window's resources:

    make_proxies.py proxies... sensors... data... proxies.xml contents.xml resources.qrc

The files of the proxies (Filters/X.xml, IO/X.xml) are ParaView's XML without the parts that follow from the rest:

- A proxy has the class `vtk` + its name, its name in words as label, and the base AvianLidarAlgorithm. `icon` puts the
  proxy into the menu Avian Lidar. `extensions` and `file_description` make a reader of files with these extensions.
- A property has its name in words as label, `Set` + its name as command (`Get` with information_only), and as many
  elements as defaults. Its text is the documentation. `range` (least and largest value, if there are any), `entries` and
  `boolean` make its domain.
- A PropertyGroup contains the properties that it shows. `group` is the label of a group of one property.
- `<Property name="X" of="Y">` is the property X of the proxy Y. Attributes and elements of the tag replace attributes
  and elements of Y's property.
- `type` and `composite` of an input make its domains. `entries` of an enumeration count from 0, except `Name=number`.
- `requires` of a domain is the property that it uses, as in "Input" or, with a function, "Other=HalfBeamwidth".
- `visible_if` and `enabled_if`, as in "Kind=0 1" or "Kind!=4", make decorators. An empty text makes no decorator.
- A PSWriterProxy has the properties of its core, which ParaView's writer for several ranks contains.

Each sensor file makes one more source: the beam source with the file's values as defaults, in a category of its maker.
This source finds its tables, which are not properties, by the sensor's name. contents.xml is the help's table of
contents. The resources are the data files and the icons that proxies and macros name. CMake runs this script."""

import copy
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

CATEGORY = "Avian Lidar"
BASE = "AvianLidarBeamSource"
# Chapters of the help for pages that are not of a reader, a writer or a filter; first pages of all chapters.
CHAPTERS = {"Beam Source": "Sensors", "Bird Source": "Birds", "Tracks": "Birds", "Medium": "Air",
            "Medium In Surface": "Air"}
FIRST_PAGES = {"Sensors": f"sources.{BASE}.html", "Birds": "sources.AvianLidarBirdSource.html",
               "Air": "sources.AvianLidarMedium.html", "Filters": "filters.AvianLidarEchoFilter.html",
               "Readers": "Readers.html", "Writers": "Writers.html"}
# The common part of all writers. With several ranks, the first rank gathers the points and writes them. ParaView's
# writer of series puts a slash before names without a folder. With GivenFileName the core removes the slash.
WRITER = """<ServerManagerConfiguration>
<Proxy name="{name}Core" class="vtk{name}">
  <StringVectorProperty name="GivenFileName" number_of_elements="1" panel_visibility="never">
    <Documentation>Name of the file as given by the user, without the number of a step.</Documentation>
  </StringVectorProperty>
</Proxy>
<PSWriterProxy name="{name}" class="vtkParallelSerialWriter" file_name_method="SetMadeFileName" label="{label}"
  base_proxygroup="internal_writers" base_proxyname="ParallelSerialWriter">
  <InputProperty name="Input" command="SetInputConnection" panel_visibility="never">
    <DataTypeDomain name="input_type" composite_data_supported="0"><DataType value="vtkPolyData" /></DataTypeDomain>
    <Documentation>Echoes: points in metres.</Documentation>
  </InputProperty>
  <StringVectorProperty name="FileName" number_of_elements="1" panel_visibility="never">
    <Documentation>The file to write. The writer makes the whole file, or no file.</Documentation>
  </StringVectorProperty>
  <SubProxy>
    <Proxy name="Writer" proxygroup="internal_writers" proxyname="{name}Core" />
    <ExposedProperties />
    <LinkProperties><Property name="GivenFileName" with_property="FileName" /></LinkProperties>
  </SubProxy>
  <SubProxy><Proxy name="PostGatherHelper" proxygroup="filters" proxyname="AppendPolyData" /></SubProxy>
</PSWriterProxy>
</ServerManagerConfiguration>"""


def words(name):
    """RaysPerBeam -> Rays Per Beam, UTMZone -> UTM Zone, Airport16 -> Airport 16."""
    return re.sub(r"(?<=[a-z])(?=[A-Z\d])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name)


def element(parent, tag, **attributes):
    return ElementTree.SubElement(parent, tag, attributes)


def child(parent, tag):
    """The first child with this tag, which is made if missing."""
    found = parent.find(tag)
    return element(parent, tag) if found is None else found


def is_property(one):
    """Whether an element defines a property. A group or a link only names a property."""
    return one.tag.endswith("Property") and (one.tag != "Property" or len(one) > 0 or "of" in one.attrib)


def spread(prop):
    """Makes elements of the text and of the attributes that stand for a domain."""
    parts = []
    if "range" in prop.attrib:
        ends = zip(("min", "max"), prop.attrib.pop("range").split())
        parts.append(ElementTree.Element(prop.tag.replace("VectorProperty", "RangeDomain"), {"name": "range", **dict(ends)}))
    if "entries" in prop.attrib:
        parts.append(ElementTree.Element("EnumerationDomain", name="enum", entries=prop.attrib.pop("entries")))
    if prop.attrib.pop("boolean", ""):
        parts.append(ElementTree.Element("BooleanDomain", name="bool"))
    if (prop.text or "").strip():
        parts.append(ElementTree.Element("Documentation"))
        parts[-1].text, prop.text = prop.text, None
    prop[:0] = parts


def ungroup(proxy):
    """Moves properties out of their groups. The groups then name the properties."""
    for i, prop in enumerate(proxy):
        if "group" in prop.attrib:
            proxy[i] = ElementTree.Element("PropertyGroup", label=prop.attrib.pop("group"))
            proxy[i].append(prop)
    for group in proxy.findall("PropertyGroup"):
        for i, prop in enumerate(list(group)):
            if is_property(prop):
                group[i] = ElementTree.Element("Property", name=prop.get("name"))
                if "function" in prop.attrib:
                    group[i].set("function", prop.attrib.pop("function"))
                proxy.insert(list(proxy).index(group), prop)


def resolved(prop, proxies):
    """The property; with the attribute `of`, a changed copy of the other proxy's property."""
    if "of" not in prop.attrib:
        return prop
    known = {one.get("name"): one for one in proxies[prop.get("of")] if is_property(one)}
    found = copy.deepcopy(resolved(known[prop.get("name")], proxies))
    found.attrib.update((key, value) for key, value in prop.items() if key != "of")
    for part in prop:
        for old in found.findall(part.tag):
            found.remove(old)
        found.append(part)
    return found


def complete_input(prop):
    if "type" in prop.attrib:
        groups = ElementTree.Element("ProxyGroupDomain", name="groups")
        groups.extend(ElementTree.Element("Group", name=name) for name in ("sources", "filters"))
        types = ElementTree.Element("DataTypeDomain", name="input_type")
        if "composite" in prop.attrib:
            types.set("composite_data_supported", prop.attrib.pop("composite"))
        types.extend(ElementTree.Element("DataType", value=name) for name in prop.attrib.pop("type").split())
        prop[:0] = groups, types
    prop.attrib.setdefault("command", "SetInputConnection")


def complete_values(prop):
    """Adds the parts that a property with values leaves out."""
    kind, name = prop.tag.replace("VectorProperty", ""), prop.get("name")
    result = "information_only" in prop.attrib
    if result and not any(one.tag.endswith("Helper") for one in prop):
        prop.insert(0, ElementTree.Element(f"Simple{kind}InformationHelper"))
        prop.attrib.update(number_of_elements="1", default_values="none")
    if prop.find("TimeStepsInformationHelper") is None:
        prop.attrib.setdefault("command", ("Get" if result else "Set") + name)
    default = prop.get("default_values")
    if default is not None:
        prop.attrib.setdefault("number_of_elements", "1" if kind == "String" else str(len(default.split())))
    for domain in prop.findall("EnumerationDomain[@entries]"):
        for i, entry in enumerate(domain.attrib.pop("entries").split()):
            text, _, value = entry.partition("=")
            element(domain, "Entry", text=text, value=value or str(i))
    for domain in prop.findall("*[@requires]"):
        function, _, other = domain.attrib.pop("requires").partition("=")
        element(child(domain, "RequiredProperties"), "Property", name=other or function, function=function)
    for key, mode in (("visible_if", "visibility"), ("enabled_if", "enabled_state")):
        condition = prop.attrib.pop(key, "")
        if condition:
            other, inverse, values = re.fullmatch(r"(\w+)(!?)=(.+)", condition).groups()
            decorator = {"type": "GenericDecorator", "mode": mode, "property": other}
            decorator["values" if " " in values else "value"] = values
            if inverse:
                decorator["inverse"] = "1"
            element(child(prop, "Hints"), "PropertyWidgetDecorator", **decorator)


def complete(proxy):
    """Adds the parts that a proxy with its properties leaves out."""
    for prop in filter(is_property, proxy):
        prop.attrib.setdefault("label", words(prop.get("name")))
        if prop.tag == "InputProperty":
            complete_input(prop)
        elif prop.tag.endswith("VectorProperty"):
            complete_values(prop)
    if "icon" in proxy.attrib:
        icon = f":/AvianLidar/{proxy.attrib.pop('icon')}.svg"
        child(proxy, "Hints").insert(0, ElementTree.Element("ShowInMenu", category=CATEGORY, icon=icon))
    if "extensions" in proxy.attrib:
        files = {name: proxy.attrib.pop(name) for name in ("extensions", "file_description")}
        element(child(proxy.find("*[@name='FileName']"), "Hints"), "FileChooser", **files)
        if "filename_patterns" in proxy.attrib:
            files["filename_patterns"] = proxy.attrib.pop("filename_patterns")
            del files["extensions"]
        hints = child(proxy, "Hints")
        hints[:0] = ElementTree.Element("ReloadFiles", property="Reload"), ElementTree.Element("ReaderFactory", files)


def complete_header(proxy):
    proxy.attrib.setdefault("class", "vtk" + proxy.get("name"))
    proxy.attrib.setdefault("label", words(proxy.get("name")))
    if "base_proxyname" not in proxy.attrib:
        proxy.attrib.update(base_proxygroup="internal_avian_lidar", base_proxyname="AvianLidarAlgorithm")


def writer(short):
    """(core, writer) from the short proxy of a writer."""
    name = short.get("name")
    core, proxy = ElementTree.fromstring(WRITER.format(name=name, label=short.get("label", words(name))))
    homes = {"PropertyGroup": proxy.find("SubProxy/ExposedProperties"), "InputArrayDomain": proxy.find("InputProperty")}
    for part in list(short):
        (core if is_property(part) else homes.get(part.tag, proxy)).append(part)
    files = {name: short.get(name) for name in ("extensions", "file_description")}
    element(child(proxy, "Hints"), "WriterFactory", **files)
    complete(core)
    complete(proxy)
    return core, proxy


def expanded(files):
    """The proxies of the files in the form that ParaView reads, in one element."""
    root = ElementTree.Element("ServerManagerConfiguration")
    for file in files:
        read = ElementTree.parse(file).getroot()
        root.extend([read] if read.tag == "ProxyGroup" else read)
    proxies = {proxy.get("name"): proxy for group in root for proxy in group}
    for proxy in proxies.values():
        for prop in proxy.iter():
            if prop.tag.endswith("Property"):
                spread(prop)
        ungroup(proxy)
    for proxy in proxies.values():
        proxy[:] = [resolved(one, proxies) if is_property(one) else one for one in proxy]
    cores = element(root, "ProxyGroup", name="internal_writers")
    for group in root.findall("ProxyGroup"):
        for i, proxy in enumerate(list(group)):
            if proxy.tag == "PSWriterProxy":
                core, group[i] = writer(proxy)
                cores.append(core)
            elif group is not cores:
                complete(proxy)
                if not group.get("name").startswith("internal"):
                    complete_header(proxy)
    return root


def overridden(prop, value):
    """A copy of the property with another default."""
    found = copy.deepcopy(prop)
    values = value if isinstance(value, list) else [value]
    text = value if isinstance(value, str) else " ".join(map(repr, values))
    found.attrib.update(default_values=text, number_of_elements=str(len(values)), override="1")
    return found


def sensor_source(sensor, base):
    """(name of the lidar with its maker, its source) from a sensor file."""
    name, model, maker = sensor["name"], sensor.get("model", words(sensor["name"])), sensor.get("maker")
    full = model if maker in (None, "assumed") else f"{maker} {model}"
    # Without "_", because ParaView's help splits names there.
    proxy = ElementTree.Element("SourceProxy", {
        "name": "AvianLidar" + name.replace("_", ""), "class": "vtk" + BASE,
        "label": f"{CATEGORY} {name.replace('_', ' ') if maker not in (None, 'assumed') else model}",
        "base_proxygroup": "sources", "base_proxyname": BASE})
    documentation = element(proxy, "Documentation", short_help=f"The sensor {full}.", long_help=sensor["comment"] + ".")
    documentation.text = (
        f"The beam source with the values of this sensor: {sensor['comment']}. The sensor file {name} gives the source "
        "of each number. The field data assumed gives the names of values that nobody has measured. All values can be "
        "changed here.")
    values = {key.title().replace("_", ""): number["value"] for key, number in sensor["values"].items()}
    if "HalfBeamwidth" in values:
        values["BeamwidthMilliradians"] = round(2000 * values["HalfBeamwidth"], 9)
    properties = {prop.get("name"): prop for prop in base if is_property(prop)}
    proxy.extend(overridden(properties[key], value) for key, value in values.items() if key in properties)
    proxy.append(overridden(properties["TablesOfPreset"], name))
    hints = element(proxy, "Hints")
    category = f"{CATEGORY}: {maker[0].upper() + maker[1:]}" if maker else CATEGORY
    element(hints, "ShowInMenu", category=category, icon=":/AvianLidar/sensor.svg")
    if full != model:
        element(hints, "AvianLidarMenu", text=full, pipeline="1")  # name in the menu and in the pipeline
    hints.extend(base.find("Hints")[1:])
    return full, proxy


def contents(root, sensors):
    """The help's table of contents: chapters of (title, page)."""
    chapters = {chapter: [] for chapter in FIRST_PAGES}
    for group in root:
        for proxy in () if group.get("name").startswith(("internal", "representations")) else group:
            kind = "Readers" if proxy.find("Hints/ReaderFactory") is not None else group.get("name").capitalize()
            title, page = proxy.get("label")[len(CATEGORY) + 1:], f"{group.get('name')}.{proxy.get('name')}.html"
            chapters[CHAPTERS.get(title, kind)].append((title, page))
    toc = ElementTree.Element("toc")
    top = element(toc, "section", title=CATEGORY, ref="index.html")
    element(top, "section", title="Start here", ref="index.html")
    for chapter, pages in chapters.items():
        section = element(top, "section", title=chapter, ref=FIRST_PAGES[chapter])
        if chapter == "Sensors":
            pages += ((full, f"sources.{proxy.get('name')}.html") for full, proxy in sensors)
        for title, page in sorted(pages, key=lambda one: (one[0] != "Beam Source", one)):
            element(section, "section", title=title, ref=page)
    return toc


def resources(root, data):
    """Qt's resources :/AvianLidar/NAME: data files, of which the first lists the macros, and icons."""
    names = {pathlib.Path(hint.get("icon")).name for hint in root.iter("ShowInMenu")}
    names.update(f"{macro['icon']}.svg" for macro in json.loads(data[0].read_text(encoding="utf-8")))
    listed = ElementTree.Element("RCC")
    folder = element(listed, "qresource", prefix="/AvianLidar")
    for file in (*data, *(pathlib.Path("Icons", name) for name in sorted(names))):
        element(folder, "file", alias=file.name).text = str(file.resolve())
    return listed


def write(path, root):
    """Writes a file that has changed. A new but equal file would make CMake build its dependents again."""
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode") + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def main(*files):
    *sources, proxies, toc, qrc = map(pathlib.Path, files)
    root = expanded(file for file in sources if file.suffix == ".xml")
    base = root.find(f"ProxyGroup/SourceProxy[@name='{BASE}']")
    others = [file for file in sources if file.suffix != ".xml"]
    sensor_files = [file for file in others if file.name.endswith(".lidarsensor.json")]
    sensors = [sensor_source(json.loads(file.read_text(encoding="utf-8")), base) for file in sensor_files]
    write(toc, contents(root, sensors))
    element(root, "ProxyGroup", name="sources").extend(proxy for _, proxy in sensors)
    write(proxies, root)
    write(qrc, resources(root, [file for file in others if file not in sensor_files]))


if __name__ == "__main__":
    main(*sys.argv[1:])
