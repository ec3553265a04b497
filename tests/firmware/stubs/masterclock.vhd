-- SonicSurface's PLL: ideal. The testbench gives the clock that the PLL makes.
library ieee;
use ieee.std_logic_1164.all;

entity Masterclock is
  port (inclk0 : in std_logic; c0 : out std_logic);
end entity;

architecture ideal of Masterclock is
begin
  c0 <= inclk0;
end architecture;
