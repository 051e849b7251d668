// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarAdvise_h
#define AvianLidarAdvise_h

/// Adds the button Advise to ParaView's panel of the echo filter. A click starts measurements of
/// errors and times on the server. The fastest settings that keep the error limits given beside the
/// button are then entered in the panel. The user then presses Apply.
void AvianLidarAddAdvise();

#endif
