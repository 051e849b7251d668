# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window from the inside: scripts that ParaView runs (--script) find and press its widgets by PyQt.

A script is a generator that yields how long to wait (seconds): between its steps ParaView works as it does for a user,
also within a dialog. What run() writes when it has ended, and only then, is a file in JSON.
gui_testing.run_script() runs it and reads that."""

import json
import os
import re
import time
import traceback

from client_qt import QAction, QtCore, QtTest, QtWidgets
from vtkmodules.vtkCommonCore import VTK_STRING, vtkOutputWindow

app = QtWidgets.QApplication.instance()
# For results and photos.
FOLDER = os.environ["AVIANLIDAR_PHOTOS"]


def run(steps):
    """Runs the generator steps(results), and writes the dictionary results with "error", the traceback, or None, to
    results.json in FOLDER."""
    results = {"error": None}
    result_name = os.path.join(FOLDER, "results.json")
    generator = steps(results)

    def step():
        try:
            wait = next(generator)
        except StopIteration:
            end()
        except BaseException:
            results["error"] = traceback.format_exc()
            end()
        else:
            QtCore.QTimer.singleShot(round(1000 * wait), step)

    def end():
        with open(result_name + ".part", "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)
        os.replace(result_name + ".part", result_name)

    QtCore.QTimer.singleShot(500, step)


def later(work):
    """Calls without waiting for the end, as that of a dialog."""
    QtCore.QTimer.singleShot(0, work)


def action(name):
    """A button or an entry of a menu."""
    return main_window().findChild(QAction, name)


def press(pressed):
    """As a click on it, until its work is done."""
    later(pressed.trigger)
    yield 0.5
    yield 1.5


def until(condition, what, timeout=60):
    """To be yielded from: waits for condition() to be true, gives its value."""
    start = time.monotonic()
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() - start < timeout, f"{what}: not within {timeout} s"
        yield 0.01


def find(name, kind=QtWidgets.QWidget, parent=None):
    """The visible widget, or the action, of this object name; None without one."""
    for top in [parent] if parent else app.topLevelWidgets():
        for found in ([top] if top.objectName() == name else []) + top.findChildren(kind, name):
            if not isinstance(found, QtWidgets.QWidget) or found.isVisible():
                return found
    return None


def action_of(menu_name, name):
    """The entry of a menu, if it fits the selection; else None. To be asked for until it is there: a menu looks what fits
    when it opens, and with a delay; a plugin that is loaded makes new entries."""
    menu = main_window().findChild(QtWidgets.QMenu, menu_name)
    menu.popup(main_window().pos())
    actions = main_window().findChildren(QAction, name)
    menu.close()
    return next((action for action in actions if action.isEnabled()), None)


def main_window():
    return find("pqClientMainWindow")


def our_entries(menu_name):
    """What a menu has in its part Avian Lidar. ParaView 5.13 fills a menu when it opens."""
    menu = main_window().findChild(QtWidgets.QMenu, menu_name)
    menu.popup(main_window().pos())
    ours = menu.findChild(QtWidgets.QMenu, "Avian Lidar")
    entries = ours.actions() if ours else []
    menu.close()
    return entries


def panel():
    return find("propertiesPanel")


def type_in(prop, text):
    """Types a value of a property into the panel."""
    line = find(prop, parent=panel()).findChild(QtWidgets.QLineEdit)
    line.setFocus()
    line.selectAll()
    QtTest.QTest.keyClicks(line, text)
    QtTest.QTest.keyClick(line, QtCore.Qt.Key.Key_Return)


def apply_button():
    return find("Accept", QtWidgets.QAbstractButton, panel())


def apply():
    """Presses Apply and waits for the end, to be yielded from."""
    yield from until(apply_button().isEnabled, "Apply")
    later(apply_button().click)
    yield from until(lambda: not apply_button().isEnabled(), "the end of Apply")
    yield 0.3


class Messages:
    """The classes that have said an error, as ParaView's Output Messages get them."""

    def __init__(self):
        self.texts = []

        def heard(_, __, text):
            self.texts.append(text)

        heard.CallDataType = VTK_STRING
        vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", heard)

    def take(self):
        texts, self.texts = self.texts, []
        return texts


def photo(file_name, widget, bottom=None):
    """What the screen shows of a widget, down to the lower end of another one if given."""
    corner = widget.mapToGlobal(QtCore.QPoint(0, 0))
    height = widget.height()
    if bottom:
        height = min(height, bottom.mapToGlobal(QtCore.QPoint(0, bottom.height())).y() - corner.y())
    picture = app.primaryScreen().grabWindow(0, corner.x(), corner.y(), widget.width(), height)
    assert picture.save(file_name), file_name


def texts_cut(widget):
    """Texts of visible widgets that have less room than they need."""
    found = []
    for child in widget.findChildren(QtWidgets.QWidget):
        if child.isVisible():
            text, room, need = _needs(child)
            if need > room:
                found.append(f"{text!r} needs {need} of {room} pixels")
    return found


def _needs(widget):
    """(text, room, need) in pixels; (.., 0, 0) for what has no text."""
    metrics = widget.fontMetrics()
    if isinstance(widget, QtWidgets.QLabel) and widget.text():
        text = re.sub("<.*?>", "", widget.text())
        if widget.wordWrap():
            longest = max(map(metrics.horizontalAdvance, text.split()))
            if longest > widget.width():
                return text, widget.width(), longest
            return text, widget.height(), widget.heightForWidth(widget.width())
        return text, widget.width(), widget.sizeHint().width()
    if isinstance(widget, (QtWidgets.QCheckBox, QtWidgets.QPushButton)) and widget.text():
        return widget.text(), widget.width(), widget.minimumSizeHint().width()
    if isinstance(widget, QtWidgets.QComboBox) and widget.count():
        texts = [widget.itemText(i) for i in range(widget.count())]
        text = max(texts, key=metrics.horizontalAdvance)
        option = QtWidgets.QStyleOptionComboBox()
        option.initFrom(widget)
        box = widget.style().subControlRect(
            QtWidgets.QStyle.ComplexControl.CC_ComboBox, option, QtWidgets.QStyle.SubControl.SC_ComboBoxEditField, widget
        )
        return text, box.width(), metrics.horizontalAdvance(text)
    if isinstance(widget, QtWidgets.QLineEdit) and widget.text():
        return widget.text(), widget.width() - 8, metrics.horizontalAdvance(widget.text())
    return "", 0, 0
