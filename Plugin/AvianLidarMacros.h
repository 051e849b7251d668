// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarMacros_h
#define AvianLidarMacros_h

/**
 * Called when the plugin is loaded: the macros that are installed beside it are among ParaView's
 * from then on, in the menu and as buttons. Without a window (pvpython, pvserver) nobody looks for
 * them.
 */
void AvianLidarAddMacros();

#endif
