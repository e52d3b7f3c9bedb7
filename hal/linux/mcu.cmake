# Trigger controller: serial line, its protocol, flashing over UART and USB.
find_package(PkgConfig REQUIRED)
pkg_check_modules(LIBUSB REQUIRED IMPORTED_TARGET libusb-1.0)
pkg_check_modules(LIBSERIALPORT REQUIRED IMPORTED_TARGET libserialport)
target_sources(mixrig_linux PRIVATE
  dfuse.cpp firmware_image.cpp flash_image.cpp libusb_control.cpp stm32_rom.cpp mcu_link.cpp mcu_trigger.cpp posix_byte_stream.cpp serial_byte_stream.cpp
  service_notify.cpp)
target_link_libraries(mixrig_linux PUBLIC mixrig::protocol PRIVATE PkgConfig::LIBSERIALPORT PkgConfig::LIBUSB)
