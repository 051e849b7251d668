# SPDX-License-Identifier: BSD-3-Clause
"""PyQt for the Qt that ParaView runs with: 5 or 6. QAction moved between them."""

with open("/proc/self/maps", encoding="utf-8") as libraries:
    QT_6 = "libQt6Core" in libraries.read()
if QT_6:
    from PyQt6 import QtCore, QtGui, QtTest, QtWidgets

    QAction = QtGui.QAction
else:
    from PyQt5 import QtCore, QtGui, QtTest, QtWidgets

    QAction = QtWidgets.QAction

__all__ = ["QAction", "QtCore", "QtGui", "QtTest", "QtWidgets"]
