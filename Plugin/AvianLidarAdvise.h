// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarAdvise_h
#define AvianLidarAdvise_h

/// ParaView's panel of the echo filter has the button Advise, which measures on the server which
/// settings meet the errors beside it, and sets them in the panel, to be applied.
void AvianLidarAddAdvise();

#endif
