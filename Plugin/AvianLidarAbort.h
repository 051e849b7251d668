// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarAbort_h
#define AvianLidarAbort_h

/**
 * Called when the plugin is loaded: from then on the abort button in the status bar of ParaView's
 * window works while a source, reader or filter of the plugin executes in this process. A window
 * that is made later is found. Without a window (pvpython, pvserver), without X11, or as the client
 * of a pvserver, nothing is changed.
 */
void AvianLidarAddAbort();

#endif
