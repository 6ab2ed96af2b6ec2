// Entry of the program, still in flash: copies the whole program to RAM, clears its variables, goes to main. From then
// on nothing is read from flash: no cache miss delays an interrupt, and the flash chip is free for commands.

    .syntax unified
    .cpu cortex-m0plus
    .thumb

    .section .flash_vectors, "a"
    .word __stack_top
    .word start

    .section .flash_start, "ax"
    .global start
    .type start, %function
    .thumb_func
start:
    ldr r0, =__image_load
    ldr r1, =__image_begin
    ldr r2, =__image_end
1:  ldmia r0!, {r3}
    stmia r1!, {r3}
    cmp r1, r2
    blo 1b
    ldr r1, =__bss_begin
    ldr r2, =__bss_end
    movs r3, #0
    b 3f
2:  stmia r1!, {r3}
3:  cmp r1, r2
    blo 2b
    ldr r1, =0xE000ED08         // VTOR: the table in RAM
    ldr r2, =__image_begin
    str r2, [r1]
    ldr r0, =main
    bx r0
    .ltorg
