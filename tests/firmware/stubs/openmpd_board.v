// An OpenMPD board from outside: the two clocks, the master's switch, the cable between boards, the chip's pins, and the pins
// that go to the shift registers.
module openmpd_board
  (input  clock,           // 50 MHz
   input  pll_clock,       // what the PLL makes of it
   input  master,
   input  sync_in,
   output sync_out,
   input  rxf_n,
   output rd_n,
   input  [7:0] bytes,
   output [31:0] data,
   output shift_clock,
   output latch_clock);
  wire sync_main;
  wire [7:0] usb_data;
  wire [3:0] rclk, sclk;
  assign sync_main = master ? 1'bz : sync_in;
  assign usb_data = bytes;
  assign latch_clock = rclk[0];
  assign shift_clock = sclk[0];
  top board (.CLK(clock), .MS_SELECT(master), .SYNC_MAIN(sync_main), .SYNC_REF(sync_out), .RXF_N(rxf_n), .USB_DATA(usb_data), .RD_N(rd_n),
    .DATA(data), .ILLUMI(), .RCLK(rclk), .SCLK(sclk), .VS_TOG(), .LED());
endmodule

// The PLL: its frequency and phase are ideal.
module Masterclock (input inclk0, output c0, output c1);
  assign c0 = openmpd_board.pll_clock;
  assign c1 = openmpd_board.pll_clock;
endmodule
