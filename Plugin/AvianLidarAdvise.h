// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarAdvise_h
#define AvianLidarAdvise_h

/// Adds the button Advise to ParaView's panel of the echo filter. The button measures on the server
/// which settings keep the error limits given beside it, and enters these settings in the panel.
/// The user then presses Apply.
void AvianLidarAddAdvise();

#endif
