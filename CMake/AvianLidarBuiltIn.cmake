# SPDX-License-Identifier: BSD-3-Clause
# Built-in data files of Filters/. The plugin makes a source from each sensor.

set(built_in_files
  Birds/species.csv
  Media/media.json
  Sensors/Airport16.lidarsensor.json
  Sensors/Airport32.lidarsensor.json
  Sensors/Automotive16.lidarsensor.json
  Sensors/Avia.lidarsensor.json
  Sensors/CorridorC16.lidarsensor.json
  Sensors/HDL32E.lidarsensor.json
  Sensors/Helios16P.lidarsensor.json
  Sensors/Mid360.lidarsensor.json
  Sensors/Mid40.lidarsensor.json
  Sensors/OS0_128.lidarsensor.json
  Sensors/OS1_64.lidarsensor.json
  Sensors/OS2_128.lidarsensor.json
  Sensors/Pandar40P.lidarsensor.json
  Sensors/PandarXT32.lidarsensor.json
  Sensors/Search1550.lidarsensor.json
  Sensors/Search905.lidarsensor.json
  Sensors/VLP16.lidarsensor.json
  Sensors/VLP32C.lidarsensor.json)
