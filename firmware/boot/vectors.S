// Exceptions and interrupts, in RAM with the rest of the program. Data-ready has its own handler, the other lines only
// wake the main loop; anything unforeseen stops here until the watchdog starts the board anew.

    .syntax unified
    .cpu cortex-m0plus
    .thumb

    .section .vectors, "a"
    .word __stack_top
    .word start
    .rept 14
    .word stopped               // exceptions 2..15
    .endr
    .word on_wake               // 0  timer, alarm 0
    .rept 4
    .word stopped
    .endr
    .word on_wake               // 5  USB
    .rept 7
    .word stopped
    .endr
    .word on_data_ready         // 13 pins
    .rept 9
    .word stopped
    .endr
    .word on_wake               // 23 I2C0
    .rept 8
    .word stopped
    .endr

    .section .text.stopped, "ax"
    .type stopped, %function
    .thumb_func
stopped:
    b stopped
