// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarErrors_h
#define AvianLidarErrors_h

/**
 * Called when the plugin is loaded: from then on a source, reader or filter of the plugin that
 * fails in ParaView's window, on its own or as the client of a pvserver, leaves its error as field
 * data of empty outputs (property ErrorsAsData). ParaView 5.11 never updates again a representation
 * whose pipeline has failed; so the next good execution shows. File > Save Data cannot be chosen
 * for such an output: a file that was good stays as it is. Without a window nothing is changed.
 */
void AvianLidarKeepErrors();

#endif
