// Interrupt numbers of the RP2040 (data sheet, 2.3.2) that the models raise.

export const IRQ_TIMER_0 = 0;
export const IRQ_USBCTRL = 5;
export const IRQ_I2C0 = 23;
