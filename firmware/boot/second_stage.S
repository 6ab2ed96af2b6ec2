// Second stage of the boot: the ROM copies these 256 bytes to 0x20041F00 when their CRC is right and runs them. Sets
// the flash interface up for plain reads (command 03h, 24-bit address, one line), which every flash of the board understands,
// and enters the program at 0x10000100. Position independent; no stack.
// Registers: RP2040 data sheet 4.10 (SSI), 2.8.1.3 (boot sequence).

    .syntax unified
    .cpu cortex-m0plus
    .thumb

    .equ SSI_CTRLR0, 0x00
    .equ SSI_CTRLR1, 0x04
    .equ SSI_ENABLE, 0x08
    .equ SSI_BAUDR, 0x14
    .equ SSI_SPI_CTRLR0, 0xF4

    .section .second_stage, "ax"
    .global second_stage
    .type second_stage, %function
    .thumb_func
second_stage:
    ldr r0, =0x18000000         // SSI
    movs r1, #0
    str r1, [r0, #SSI_ENABLE]
    movs r1, #2                 // half of clk_sys: the ring oscillator, 12 MHz at most, until the program is in RAM
    str r1, [r0, #SSI_BAUDR]
    ldr r1, =0x001F0300         // 32-bit frames, "EEPROM read": command and address out, then data in
    str r1, [r0, #SSI_CTRLR0]
    movs r1, #0                 // one frame a read
    str r1, [r0, #SSI_CTRLR1]
    ldr r1, =0x03000218         // command 03h, 8 bits; address 24 bits; all on one line
    movs r2, #SSI_SPI_CTRLR0
    str r1, [r0, r2]
    movs r1, #1
    str r1, [r0, #SSI_ENABLE]

    ldr r0, =0x10000100         // the program's vector table: stack, entry
    ldr r1, =0xE000ED08         // VTOR
    str r0, [r1]
    ldmia r0!, {r1, r2}
    msr msp, r1
    bx r2
    .ltorg
