// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarWizard_h
#define AvianLidarWizard_h

#include <QString>

class QWidget;

/**
 * Asks for scene, sensor, birds and weather of a scan, page by page; each page has the button
 * Finish, which takes the other pages as they are (at first an airport, birds and clear air).
 * @return the answers as a dictionary of Python, for the macro avian_lidar_wizard; empty if the
 * dialog was cancelled
 */
QString AvianLidarAskForScan(QWidget* parent);

#endif
