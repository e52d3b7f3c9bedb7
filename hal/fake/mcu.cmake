# The trigger board: flash, ROM bootloader and firmware behind a serial line.
target_sources(mixrig_fake PRIVATE emulated_board.cpp emulated_dfuse.cpp emulated_flash.cpp emulated_rom.cpp)
target_link_libraries(mixrig_fake PUBLIC mixrig::firmware_sim)
