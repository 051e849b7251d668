// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarErrors_h
#define AvianLidarErrors_h

class QAction;

/**
 * Disables the action of File > Save Data for an output that holds an error (property
 * ErrorsAsData), so that an existing file is not overwritten.
 */
void AvianLidarGuardSaving(QAction* saving);

#endif
