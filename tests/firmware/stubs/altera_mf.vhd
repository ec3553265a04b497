-- Models of the two blocks of Altera's library that the boards use: a memory with a write port and a read port, and a
-- buffer. Only what the boards ask for is modelled: a registered read address, outputs without registers.
library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

-- A word of the wider read port consists of the words of the write port that follow each other, the first one lowest. All
-- bits are 0 at power-up. A ROM, whose file nothing here reads, stays at 0.
entity altsyncram is
  generic (
    width_a : natural := 1; widthad_a : natural := 1; numwords_a : natural := 1;
    width_b : natural := 1; widthad_b : natural := 1; numwords_b : natural := 1;
    width_byteena_a : natural := 1;
    operation_mode, lpm_type, lpm_hint, init_file, init_file_layout, intended_device_family, power_up_uninitialized : string := "";
    address_aclr_a, address_aclr_b, address_reg_b, outdata_aclr_a, outdata_aclr_b, outdata_reg_a, outdata_reg_b : string := "";
    clock_enable_input_a, clock_enable_input_b, clock_enable_output_a, clock_enable_output_b : string := "";
    read_during_write_mode_mixed_ports : string := "");
  port (
    address_a : in std_logic_vector(widthad_a - 1 downto 0);
    address_b : in std_logic_vector(widthad_b - 1 downto 0) := (others => '0');
    clock0 : in std_logic;
    clock1 : in std_logic := '0';
    data_a : in std_logic_vector(width_a - 1 downto 0) := (others => '0');
    wren_a : in std_logic := '0';
    q_a : out std_logic_vector(width_a - 1 downto 0);
    q_b : out std_logic_vector(width_b - 1 downto 0));
end entity;

architecture model of altsyncram is
  constant lanes : natural := (width_b + width_a - 1) / width_a;
  type words is array (natural range 0 to 2 ** widthad_a - 1) of std_logic_vector(width_a - 1 downto 0);
  signal memory : words := (others => (others => '0'));
  signal read_clock : std_logic;
begin
  assert outdata_reg_a /= "CLOCK0" and outdata_reg_b /= "CLOCK0" and outdata_reg_b /= "CLOCK1" report "altsyncram: a registered output is not modelled" severity failure;

  q_a <= (others => '0');
  write : process (clock0) begin
    if rising_edge(clock0) then
      if wren_a = '1' then
        memory(to_integer(unsigned(address_a))) <= data_a;
      end if;
    end if;
  end process;

  read_clock <= clock1 when address_reg_b = "CLOCK1" else clock0;
  rom : if operation_mode = "ROM" generate
    q_b <= (others => '0');
  end generate;
  ram : if operation_mode /= "ROM" generate
    each_lane : for lane in 0 to lanes - 1 generate
      read : process (read_clock) begin
        if rising_edge(read_clock) then
          q_b((lane + 1) * width_a - 1 downto lane * width_a) <= memory(to_integer(unsigned(address_b)) * lanes + lane);
        end if;
      end process;
    end generate;
  end generate;
end architecture;

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

-- The byte that was asked for is there in the next clock; the count of waiting words is right in the next clock.
entity scfifo is
  generic (
    lpm_width : natural := 8; lpm_widthu : natural := 8; lpm_numwords : natural := 256;
    add_ram_output_register, intended_device_family, lpm_showahead, lpm_type, lpm_hint : string := "";
    overflow_checking, underflow_checking, use_eab : string := "");
  port (
    clock, rdreq, wrreq : in std_logic;
    sclr : in std_logic := '0';
    data : in std_logic_vector(lpm_width - 1 downto 0);
    empty, full : out std_logic;
    q : out std_logic_vector(lpm_width - 1 downto 0);
    usedw : out std_logic_vector(lpm_widthu - 1 downto 0));
end entity;

architecture model of scfifo is
  type words is array (natural range 0 to lpm_numwords - 1) of std_logic_vector(lpm_width - 1 downto 0);
  signal memory : words := (others => (others => '0'));
  signal head, tail : unsigned(lpm_widthu - 1 downto 0) := (others => '0');
  signal used : unsigned(lpm_widthu downto 0) := (others => '0');
  signal reads, writes : std_logic;
begin
  assert lpm_numwords = 2 ** lpm_widthu and lpm_showahead /= "ON" report "scfifo: this kind is not modelled" severity failure;

  empty <= '1' when used = 0 else '0';
  full <= used(lpm_widthu);
  usedw <= std_logic_vector(used(lpm_widthu - 1 downto 0));
  reads <= '1' when rdreq = '1' and used /= 0 else '0';
  writes <= '1' when wrreq = '1' and used(lpm_widthu) = '0' else '0';
  move : process (clock) begin
    if rising_edge(clock) then
      if writes = '1' then
        memory(to_integer(head)) <= data;
      end if;
      if reads = '1' then
        q <= memory(to_integer(tail));
      end if;
      if sclr = '1' then
        head <= (others => '0');
        tail <= (others => '0');
        used <= (others => '0');
      else
        if writes = '1' then
          head <= head + 1;
        end if;
        if reads = '1' then
          tail <= tail + 1;
        end if;
        if writes = '1' and reads = '0' then
          used <= used + 1;
        elsif writes = '0' and reads = '1' then
          used <= used - 1;
        end if;
      end if;
    end if;
  end process;
end architecture;

library ieee;
use ieee.std_logic_1164.all;

package altera_mf_components is
  component altsyncram
    generic (
      width_a : natural := 1; widthad_a : natural := 1; numwords_a : natural := 1;
      width_b : natural := 1; widthad_b : natural := 1; numwords_b : natural := 1;
      width_byteena_a : natural := 1;
      operation_mode, lpm_type, lpm_hint, init_file, init_file_layout, intended_device_family, power_up_uninitialized : string := "";
      address_aclr_a, address_aclr_b, address_reg_b, outdata_aclr_a, outdata_aclr_b, outdata_reg_a, outdata_reg_b : string := "";
      clock_enable_input_a, clock_enable_input_b, clock_enable_output_a, clock_enable_output_b : string := "";
      read_during_write_mode_mixed_ports : string := "");
    port (
      address_a : in std_logic_vector(widthad_a - 1 downto 0);
      address_b : in std_logic_vector(widthad_b - 1 downto 0) := (others => '0');
      clock0 : in std_logic;
      clock1 : in std_logic := '0';
      data_a : in std_logic_vector(width_a - 1 downto 0) := (others => '0');
      wren_a : in std_logic := '0';
      q_a : out std_logic_vector(width_a - 1 downto 0);
      q_b : out std_logic_vector(width_b - 1 downto 0));
  end component;
end package;
