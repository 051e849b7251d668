// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarUndo_h
#define AvianLidarUndo_h

#include <QString>

#include <functional>

/**
 * Runs `work` as one step of Edit > Undo in ParaView's window. The step restores sources, displays,
 * views, colours, and also cameras, which ParaView's own steps leave out.
 */
void AvianLidarDoToUndo(const QString& label, const std::function<void()>& work);

#endif
