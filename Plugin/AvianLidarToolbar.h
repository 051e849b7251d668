// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarToolbar_h
#define AvianLidarToolbar_h

/**
 * Called when the plugin is loaded: ParaView's window gets the toolbar Avian Lidar, at once or as
 * soon as there is a window. It has the macros that are installed beside the plugin, which the menu
 * Macros and, in ParaView 5.11, the quick launch (Ctrl+Space) have, too, and the echo filter. A
 * click on a macro is one step of Edit > Undo. Filters whose XML has the hint AvianLidarMenu are in
 * menus and quick launch by its text: ParaView searches these texts alone, and the label is the
 * name in Python. The first Apply gives echoes the colours of the macro and a range image its view.
 * ParaView's help gets the plugin's pages. Without a window (pvpython, pvserver) nothing happens.
 */
void AvianLidarAddToolbar();

#endif
