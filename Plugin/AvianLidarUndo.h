// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarUndo_h
#define AvianLidarUndo_h

#include <QString>

#include <functional>

/**
 * Does what is given, in ParaView's window, as one step of Edit > Undo: sources, displays, views,
 * colours, and the cameras, which ParaView itself leaves out of its steps.
 */
void AvianLidarDoToUndo(const QString& label, const std::function<void()>& work);

#endif
