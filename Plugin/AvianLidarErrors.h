// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarErrors_h
#define AvianLidarErrors_h

/**
 * Called when the plugin is loaded in ParaView's window: File > Save Data cannot be chosen for an
 * output that holds an error (property ErrorsAsData), so that a good file stays as it is.
 */
void AvianLidarGuardSaving();

#endif
