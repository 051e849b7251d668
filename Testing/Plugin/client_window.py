# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window from the inside: scripts that ParaView runs (--script) find and press its widgets by PyQt.

A part of a test is a generator that yields how long to wait (seconds): between its steps ParaView works as it does for
a user, also within a dialog. run() runs the parts and writes results.json, which gui_testing.run_script() reads."""

import json
import os
import re
import time
import traceback

import numpy
from client_qt import QAction, QtCore, QtGui, QtTest, QtWidgets
from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import VTK_STRING, vtkOutputWindow

app = QtWidgets.QApplication.instance()
FOLDER = os.environ["AVIANLIDAR_PHOTOS"]  # for results and photos
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
AIRPORT = os.path.join(SOURCE_DIR, "Examples", "airport", "scene", "hongqiao.lidarscene.json")
DOCUMENTED = "AVIANLIDAR_DOCUMENTATION" in os.environ  # pictures for the pages are wanted
results = {"error": "", "seconds": {}}
errors = []  # what ParaView's Output Messages have got


def run(*parts):
    """Runs the generators that the parts return, in turn; the tracebacks of those that fail are results["error"]. A
    part takes the errors that it expects from `errors`: one that is left fails it. AVIANLIDAR_PARTS may choose
    parts."""
    chosen = os.environ.get("AVIANLIDAR_PARTS", "").split()

    def heard(_, __, text):
        errors.append(text)

    heard.CallDataType = VTK_STRING

    def whole():
        # While a state or a script is loaded, another one is in its place.
        vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", heard)
        for part in parts:
            if chosen and part.__name__ not in chosen:
                continue
            start = time.process_time()
            try:
                yield from part()
                left = take()
                assert not left, left
            except Exception:
                results["error"] += f"{part.__name__}: {traceback.format_exc()}"
                photo(f"problem-{part.__name__}.png", main_window())
                take()
                while app.activeModalWidget():
                    app.activeModalWidget().reject()
                    yield 0.3
                yield from delete_all()
            close_messages()
            results["seconds"][part.__name__] = round(time.process_time() - start, 1)
            with open(os.path.join(FOLDER, "results.part"), "w", encoding="utf-8") as file:
                json.dump(results, file, indent=1)
        os.replace(file.name, os.path.join(FOLDER, "results.json"))

    generator = whole()

    def step():
        wait = next(generator, None)
        if wait is not None:
            QtCore.QTimer.singleShot(round(1000 * wait), step)

    QtCore.QTimer.singleShot(500, step)


def take(word=""):
    """The errors so far that have this word."""
    texts = [text for text in errors if word in text]
    errors.clear()
    return texts


def close_messages():
    """Output Messages opens by itself over the view."""
    for dock in main_window().findChildren(QtWidgets.QDockWidget):
        if "utput" in dock.objectName() + dock.windowTitle():
            dock.hide()


def later(work):
    """Calls without waiting for the end, as that of a dialog."""
    QtCore.QTimer.singleShot(0, work)


def until(condition, what, timeout=60):
    """To be yielded from: waits for condition() to be true, gives its value."""
    start = time.monotonic()
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() - start < timeout, f"{what}: not within {timeout} s"
        yield 0.01


def action(name):
    """A button or an entry of a menu."""
    return main_window().findChild(QAction, name)


def press(pressed):
    """As a click on an action or a button, until its work is done; to be yielded from."""
    done = []
    work = pressed.click if isinstance(pressed, QtWidgets.QAbstractButton) else pressed.trigger
    later(lambda: (work(), done.append(1)))
    yield from until(lambda: done, "the work of " + pressed.objectName(), 150)
    yield 0.3


def find(name, kind=QtWidgets.QWidget, parent=None):
    """The visible widget, or the action, of this object name; None without one."""
    for top in [parent] if parent else app.topLevelWidgets():
        for found in ([top] if top.objectName() == name else []) + top.findChildren(kind, name):
            if not isinstance(found, QtWidgets.QWidget) or found.isVisible():
                return found
    return None


def main_window():
    return find("pqClientMainWindow")


def menu(name):
    """A menu as a user meets it: ParaView 5.13 fills it, and looks what fits the selection, when it opens."""
    found = main_window().findChild(QtWidgets.QMenu, name)
    found.popup(main_window().pos())
    found.close()
    return found


def dialog_of(name, dialog):
    """Opens a dialog by an action, to be yielded from."""
    later(action(name).trigger)
    return (yield from until(lambda: find(dialog), dialog))


def panel():
    return find("propertiesPanel")


def panel_of(proxy, prop):
    """The widget of a property in the panel of an object, to be yielded from."""
    simple.SetActiveSource(proxy)
    return (yield from until(lambda: find(prop, parent=panel()), "the panel with " + prop))


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
    yield from press(apply_button())
    yield from until(lambda: not apply_button().isEnabled(), "the end of Apply")


def apply_value(proxy, prop, text):
    """Types a value into the panel of an object and applies it, to be yielded from."""
    yield from panel_of(proxy, prop)
    yield 0.1
    type_in(prop, text)
    yield from apply()


def names():
    return sorted(name for name, _ in simple.GetSources())


def delete_all():
    """Consumers first; to be yielded from."""
    for source in sorted(simple.GetSources().values(), key=lambda one: -one.SMProxy.GetGlobalID()):
        simple.Delete(source)
    simple.SetActiveSource(None)
    # The legend's action of ParaView 5.13 may else keep a representation whose view is gone, which ends the program.
    yield 0.3


def points_of(proxy, port=0):
    return proxy.GetDataInformation(port).GetNumberOfPoints()


def shown(source, view, port=0):
    display = servermanager.GetRepresentation(source[port], view)
    return bool(display and display.Visibility)


def canvas(view):
    """The widget that draws a view."""
    size = list(view.ViewSize)
    return next(widget for widget in app.allWidgets() if widget.isVisible() and [widget.width(), widget.height()]
                == size and "QVTK" in widget.metaObject().className())


def grab(widget, height=None):
    """What the screen shows of a widget."""
    corner = widget.mapToGlobal(QtCore.QPoint(0, 0))
    return app.primaryScreen().grabWindow(0, corner.x(), corner.y(), widget.width(), height or widget.height())


def photo(name, widget, bottom=None):
    """A picture of a widget in FOLDER, down to the lower end of another one if given."""
    height = widget.height()
    if bottom:
        corner, end = (one.mapToGlobal(QtCore.QPoint(0, 0)).y() for one in (widget, bottom))
        height = min(height, end + bottom.height() - corner)
    assert grab(widget, height).save(os.path.join(FOLDER, name)), name


def pixels(widget):
    """What the screen shows of a widget as an array (rows, columns, rgb)."""
    image = grab(widget).toImage().convertToFormat(QtGui.QImage.Format.Format_RGB888)
    bits = image.constBits()
    bits.setsize(image.sizeInBytes())
    lines = numpy.frombuffer(bits, numpy.uint8).reshape(image.height(), image.bytesPerLine())
    return lines[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def texts_cut(widget):
    """Texts of visible widgets that have less room than they need."""
    needs = [_needs(child) for child in widget.findChildren(QtWidgets.QWidget) if child.isVisible()]
    return [f"{text!r} needs {need} of {room} pixels" for text, room, need in needs if need > room]


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
        text = max((widget.itemText(i) for i in range(widget.count())), key=metrics.horizontalAdvance)
        option = QtWidgets.QStyleOptionComboBox()
        option.initFrom(widget)
        style = QtWidgets.QStyle
        box = widget.style().subControlRect(
            style.ComplexControl.CC_ComboBox, option, style.SubControl.SC_ComboBoxEditField, widget)
        return text, box.width(), metrics.horizontalAdvance(text)
    if isinstance(widget, QtWidgets.QLineEdit) and widget.text():
        return widget.text(), widget.width() - 8, metrics.horizontalAdvance(widget.text())
    return "", 0, 0
