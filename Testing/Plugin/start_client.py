# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestStart.py: loads the plugin as the Plugin Manager does, clicks its macro, looks at the
icons of its menus and reads its help.

The results: {"before": [macros without the plugin], "macros": [with it], "toolbar": [buttons], "icons": {object: whether it has one},
"pages": {page: its text}, "asked": the text that the panel's question mark opens}. Where ParaView has been told to load the
plugin at its start, a scene is opened and scanned without Apply: {"macros", "apply": is the button then enabled for the
scene, "shown": has the scene a display of its own}."""

import os

import client_window
from client_qt import QAction, QtCore, QtWidgets
from client_window import FOLDER, app, find, panel, until
from paraview import servermanager, simple

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
MACRO = "avian_lidar_airport_scan"
FILTER = "AvianLidarEchoFilter"
# Pages of the help, and a word in each that the others do not have.
PAGES = {"Start here": "One click", "Filters/Echo Filter": "AvianLidarEchoFilter"}
ASKED = "AvianLidarAirport16"


def menu(name):
    return next(found for top in app.topLevelWidgets() for found in top.findChildren(QtWidgets.QMenu, name))


def macros():
    return [action.objectName() for action in menu("menu_Macros").actions() if "Avian Lidar" in action.text()]


def toolbar():
    """The objects of the buttons that are to be seen, with a picture and a tooltip."""
    bar = find("AvianLidarToolbar", QtWidgets.QToolBar)
    buttons = [(action, bar.widgetForAction(action)) for action in (bar.actions() if bar else ())]
    return [action.objectName() for action, button in buttons
            if button.isVisible() and not button.icon().pixmap(24, 24).isNull() and "lidar" in action.toolTip().lower()]


def click_macro():
    next(action for action in menu("menu_Macros").actions() if action.objectName() == MACRO).trigger()


def scanned():
    """What the macro makes is selected at its end."""
    return simple.GetActiveSource() and simple.GetActiveSource() == simple.FindSource("Scan")


def icons():
    """Of the plugin's sources and filters: whether what the menus show beside them is a picture."""
    found = {}
    for name in ("menuSources", "menuFilters"):
        ours = client_window.our_entries(name)
        found.update({a.objectName(): not a.icon().pixmap(24, 24).isNull() for a in ours})
    return found


def help_window():
    return next((top for top in app.topLevelWidgets() if top.metaObject().className() == "pqHelpWindow"), None)


def page_text():
    """What the help shows; nothing without its window."""
    top = help_window()
    browser = top and top.findChild(QtWidgets.QTextBrowser)
    return browser.toPlainText() if browser else ""


def choose(path):
    """Clicks a page in the table of contents; whether it is there already."""
    tree = next(t for t in help_window().findChildren(QtWidgets.QTreeView) if t.inherits("QHelpContentWidget"))
    index = QtCore.QModelIndex()
    for part in ("Avian Lidar", *path.split("/")):
        rows = [tree.model().index(row, 0, index) for row in range(tree.model().rowCount(index))]
        index = next((row for row in rows if row.data() == part), None)
        if index is None:
            return False
    tree.setCurrentIndex(index)
    tree.activated.emit(index)
    return True


def read_help(results):
    find("actionHelp", QAction).trigger()
    yield from until(help_window, "the window of the help")
    help_window().resize(1400, 900)
    results["pages"] = {}
    for page, word in PAGES.items():
        yield from until(lambda: choose(page), page)
        yield from until(lambda: word in page_text(), f"{word} in the page {page}")
        results["pages"][page] = page_text()
        yield 0.5  # for the photo alone: the text is drawn later
        client_window.photo(os.path.join(FOLDER, f"help-{os.path.basename(page).replace(' ', '-')}.png"), help_window())
    help_window().close()


def ask(results):
    """The question mark in the panel of the selected object."""
    find("Help", QtWidgets.QAbstractButton, panel()).click()
    yield from until(lambda: ASKED in page_text(), "the page of the selected object")
    results["asked"] = page_text()


def image(results):
    """The first Apply of a range image of the airport, photographed."""
    source = simple.AvianLidarRangeImage(Echoes=simple.FindSource("Scan"), Beams=simple.FindSource("Airport 16"))
    simple.SetActiveSource(source)
    yield 0.3
    find("AdvancedButton", parent=panel()).click()
    yield from until(lambda: find("Columns", parent=panel()), "the panel of the range image")
    client_window.type_in("Columns", "960")
    yield from until(lambda: apply_button().isEnabled(), "Apply")
    apply_button().click()
    find("AdvancedButton", parent=panel()).click()
    yield from until(lambda: simple.GetActiveView().InteractionMode == "2D", "the view of the range image")
    yield 2  # for the photo alone: the window is laid out anew
    results["mode"] = str(simple.GetActiveView().InteractionMode)
    client_window.photo(os.path.join(FOLDER, "range-image.png"), client_window.main_window())


def steps(results):
    results["before"] = macros()
    simple.LoadPlugin(os.environ["AVIANLIDAR_PLUGIN"], remote=False, ns=vars(simple))
    # The filter comes with the menu of filters, a moment later than the macros.
    yield from until(lambda: FILTER in toolbar(), "the filter in the toolbar")
    results["macros"], results["toolbar"] = macros(), toolbar()
    client_window.photo(os.path.join(FOLDER, "toolbar.png"), find("AvianLidarToolbar"))
    click_macro()
    yield from until(scanned, MACRO)
    simple.SaveState(os.path.join(FOLDER, "clicked.pvsm"))
    results["icons"] = icons()
    yield from read_help(results)
    simple.SetActiveSource(simple.FindSource("Airport 16"))
    yield from until(lambda: find("NumberOfChannels", parent=panel()), "the panel of Airport 16")
    yield from ask(results)
    help_window().close()
    yield from image(results)


def apply_button():
    return find("Accept", QtWidgets.QAbstractButton, panel())


def scan_unapplied(results):
    """File > Open, and at once the macro: it applies what was opened, and leaves nothing to the button."""
    client_window.later(find("actionFileOpen", QAction).trigger)
    dialog = yield from until(lambda: find("FileOpenDialog"), "the dialog")
    find("EntityName", QtWidgets.QLineEdit, dialog).setText(SCENE)
    client_window.later(find("OK", parent=dialog).click)
    scene = yield from until(simple.GetActiveSource, "the scene")
    yield from until(lambda: apply_button().isEnabled(), "Apply")
    click_macro()
    yield from until(scanned, MACRO)
    simple.SetActiveSource(scene)
    name = os.path.basename(SCENE)
    yield from until(lambda: name in find("PropertiesButton", parent=panel()).text(), "the panel of the scene")
    results["apply"] = apply_button().isEnabled()
    results["shown"] = bool(servermanager.GetRepresentation(scene, simple.GetActiveView()))


def started_with_plugin(results):
    yield from until(lambda: FILTER in toolbar(), "the filter in the toolbar")
    results["macros"] = macros()
    yield from scan_unapplied(results)


run = started_with_plugin if "PV_PLUGIN_CONFIG_FILE" in os.environ else steps
client_window.run(run)
