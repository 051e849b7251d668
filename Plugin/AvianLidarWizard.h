// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarWizard_h
#define AvianLidarWizard_h

#include <QString>

class QWidget;

/**
 * Shows a dialog for scene, sensor, birds and weather of a scan, page by page. Each page has the
 * button Finish, which accepts all pages (the defaults are an airport, birds and clear air).
 * @return the answers as a dictionary of Python, for the macro avian_lidar_wizard; empty if the
 * dialog was cancelled
 */
QString AvianLidarAskForScan(QWidget* parent);

#endif
