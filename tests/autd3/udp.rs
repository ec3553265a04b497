// AUTD3 units of the UDP line as their makers emulate them, behind a relay that can drop, repeat, mute and delay
// datagrams. It asks standard input what to do, a command a line, and answers each with a line of JSON:
// `dump`: what each unit sounds now; `sounds`: whether any does; `parts`: all patterns of the bank
// that sounds (of a pattern kept for ever); `drop U N`, `dropanswer U N`, `repeat U N`: the next N frames of unit U; `mute U 0|1`; `delay US`; `quit`.
// Intensities are after mask and failsafe, and before modulation. The emulators run frames at once, whatever their time.
use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::{BufRead, Write};
use std::net::{Ipv6Addr, SocketAddr, SocketAddrV6, UdpSocket};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use emulator::autd3_cpu_fw::{FW_VERSION_MAJOR, FW_VERSION_MINOR, FW_VERSION_PATCH};
use emulator::udp::UdpEmulator;

const GROUP: usize = usize::MAX;

fn bind(port: u16) -> std::io::Result<Arc<UdpSocket>> {
    let s = UdpSocket::bind(SocketAddrV6::new(Ipv6Addr::LOCALHOST, port, 0, 0))?;
    s.set_read_timeout(Some(Duration::from_millis(200)))?;
    Ok(Arc::new(s))
}

#[derive(Default)]
struct Faults {
    drop_frames: HashMap<usize, u64>,
    drop_answers: HashMap<usize, u64>,
    repeat_frames: HashMap<usize, u64>,
    muted: HashMap<usize, bool>,
    delay_us: u64,
}

struct Relay {
    emu: Arc<UdpEmulator>,
    fronts: Mutex<Vec<Arc<UdpSocket>>>,
    backs: Mutex<HashMap<SocketAddr, Arc<UdpSocket>>>,
    ports: Mutex<HashMap<u16, usize>>,
    faults: Mutex<Faults>,
    counts: Vec<[AtomicU64; 5]>, // frames, heartbeats, answers, refused, dropped
}

fn take(map: &mut HashMap<usize, u64>, unit: usize) -> bool {
    match map.get_mut(&unit) {
        Some(n) if *n > 0 => {
            *n -= 1;
            true
        }
        _ => false,
    }
}

impl Relay {
    fn unit_of(&self, port: u16) -> Option<usize> {
        let mut ports = self.ports.lock().unwrap();
        for i in 0..self.emu.num_devices() {
            ports.insert(self.emu.device_addr(i).port(), i);
        }
        ports.get(&port).copied()
    }

    fn back(self: &Arc<Self>, client: SocketAddr) -> Arc<UdpSocket> {
        let mut backs = self.backs.lock().unwrap();
        if let Some(b) = backs.get(&client) {
            return Arc::clone(b);
        }
        let b = bind(0).expect("a socket towards the emulator");
        backs.insert(client, Arc::clone(&b));
        let (me, sock) = (Arc::clone(self), Arc::clone(&b));
        std::thread::spawn(move || {
            let mut buf = [0u8; 2048];
            loop {
                let Ok((n, src)) = sock.recv_from(&mut buf) else { continue };
                let Some(unit) = me.unit_of(src.port()) else { continue };
                let d = &buf[..n];
                let frame = n >= 2 && (d[1] == 0 || d[1] == 7);
                if frame && take(&mut me.faults.lock().unwrap().drop_answers, unit) {
                    me.counts[unit][4].fetch_add(1, Ordering::Relaxed);
                    continue;
                }
                me.counts[unit][2].fetch_add(1, Ordering::Relaxed);
                if n >= 6 && (d[1] == 0 && d[5] != 0 || d[1] != 0 && d[1] != 7 && d[4] != 0) {
                    me.counts[unit][3].fetch_add(1, Ordering::Relaxed);
                }
                if n >= 5 && d[1] == 4 && d[4] == 0 {
                    me.open_front(Some(unit)).expect("a new address for a unit");
                }
                let front = Arc::clone(&me.fronts.lock().unwrap()[unit]);
                let _ = front.send_to(d, client);
            }
        });
        b
    }

    fn open_front(self: &Arc<Self>, unit: Option<usize>) -> std::io::Result<Arc<UdpSocket>> {
        let s = bind(0)?;
        let index = {
            let mut f = self.fronts.lock().unwrap();
            match unit {
                Some(i) => {
                    f[i] = Arc::clone(&s);
                    i
                }
                None => {
                    f.push(Arc::clone(&s));
                    f.len() - 1
                }
            }
        };
        self.serve(Arc::clone(&s), index);
        Ok(s)
    }

    fn serve(self: &Arc<Self>, sock: Arc<UdpSocket>, unit: usize) {
        let me = Arc::clone(self);
        std::thread::spawn(move || {
            let mut buf = [0u8; 2048];
            loop {
                let Ok((n, src)) = sock.recv_from(&mut buf) else { continue };
                let d = &buf[..n];
                if unit != GROUP && !Arc::ptr_eq(&sock, &me.fronts.lock().unwrap()[unit]) {
                    continue; // to an address that the unit has left
                }
                let to = if unit == GROUP { me.emu.addr() } else { me.emu.device_addr(unit) };
                let mut times = 1;
                let kind = if n >= 2 { d[1] } else { 0xff };
                if unit != GROUP && (kind == 0 || kind == 7) {
                    let mut f = me.faults.lock().unwrap();
                    me.counts[unit][if kind == 0 { 0 } else { 1 }].fetch_add(1, Ordering::Relaxed);
                    if f.muted.get(&unit) == Some(&true) || kind == 0 && take(&mut f.drop_frames, unit) {
                        times = 0;
                        me.counts[unit][4].fetch_add(1, Ordering::Relaxed);
                    } else if kind == 0 && take(&mut f.repeat_frames, unit) {
                        times = 2;
                    }
                    let delay = f.delay_us;
                    drop(f);
                    if delay > 0 {
                        std::thread::sleep(Duration::from_micros(delay));
                    }
                }
                let back = me.back(src);
                for _ in 0..times {
                    let _ = back.send_to(d, to);
                }
            }
        });
    }
}

fn hex(bytes: impl Iterator<Item = u8>) -> String {
    bytes.fold(String::new(), |mut out, b| {
        let _ = write!(out, "{b:02x}");
        out
    })
}

fn unit_json(relay: &Relay, i: usize, all: bool) -> String {
    let mut o = String::new();
    relay.emu.with_device(i, |d| {
        let f = d.fpga();
        let (pb, mb) = (f.current_pattern_bank(), f.current_mod_bank());
        let (ph, it) = f.emissions();
        let m = f.modulation();
        let _ = write!(
            o,
            "{{\"failsafe\":{},\"kind\":\"{}\",\"size\":{},\"divider\":{},\"sound_speed\":{},\"sounding\":{},\
             \"phase\":\"{}\",\"intensity\":\"{}\",\"width\":[{}],\
             \"modulation\":{{\"divider\":{},\"samples\":\"{}\"}},\"silencer\":[{},{}]",
            f.failsafe(),
            if f.pattern_mode(pb) == 0 { "foci" } else { "raw" },
            f.pattern_cycle(pb),
            f.pattern_freq_div(pb),
            f.sound_speed(pb),
            it.iter().filter(|x| x.0 > 0).count(),
            hex(ph.iter().map(|x| x.0)),
            hex(it.iter().map(|x| x.0)),
            it.iter().map(|x| f.to_pulse_width(*x, m).to_string()).collect::<Vec<_>>().join(","),
            f.modulation_freq_div(mb),
            hex(f.modulation_buffer(mb).into_iter()),
            f.silencer_completion_steps_intensity(),
            f.silencer_completion_steps_phase(),
        );
        if all {
            let (size, div) = (f.pattern_cycle(pb), u64::from(f.pattern_freq_div(pb)));
            o.push_str(",\"parts\":[");
            for k in 0..size {
                d.fpga_mut().update_with_sys_time(k as u64 * div * 25_000);
                let (ph, it) = d.fpga().emissions();
                let (ph, it) = (hex(ph.iter().map(|x| x.0)), hex(it.iter().map(|x| x.0)));
                let _ = write!(o, "{}[\"{ph}\",\"{it}\"]", if k > 0 { "," } else { "" });
            }
            o.push(']');
        }
    });
    let c = |k: usize| relay.counts[i][k].load(Ordering::Relaxed);
    let _ = write!(
        o,
        ",\"frames\":{},\"heartbeats\":{},\"answers\":{},\"refused\":{},\"dropped\":{}}}",
        c(0), c(1), c(2), c(3), c(4)
    );
    o
}

pub fn run(units: usize) -> Result<(), Box<dyn std::error::Error>> {
    let relay = Arc::new(Relay {
        emu: Arc::new(UdpEmulator::spawn(units)?),
        fronts: Mutex::default(),
        backs: Mutex::default(),
        ports: Mutex::default(),
        faults: Mutex::default(),
        counts: (0..units).map(|_| std::array::from_fn(|_| AtomicU64::new(0))).collect(),
    });
    for _ in 0..units {
        relay.open_front(None)?;
    }
    let group = bind(0)?;
    let address = group.local_addr()?;
    relay.serve(group, GROUP);
    println!(
        "{{\"address\":\"{address}\",\"units\":{units},\"protocol\":{},\"firmware\":\"{FW_VERSION_MAJOR}.{FW_VERSION_MINOR}.{FW_VERSION_PATCH}\"}}",
        wire::udp::PROTOCOL_VERSION
    );
    std::io::stdout().flush()?;
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let w: Vec<&str> = line.split_whitespace().collect();
        let num = |k: usize| w.get(k).and_then(|x| x.parse::<u64>().ok()).unwrap_or(0);
        let (u, n) = (num(1) as usize, num(2));
        let mut faults = relay.faults.lock().unwrap();
        let mut answer = String::from("{\"ok\":true}");
        match w.first().copied().unwrap_or("") {
            c @ ("dump" | "parts") => {
                drop(faults);
                let units: Vec<String> = (0..units).map(|i| unit_json(&relay, i, c == "parts")).collect();
                answer = format!("{{\"units\":[{}]}}", units.join(","));
            }
            "sounds" => {
                drop(faults);
                let on = |i| relay.emu.with_device(i, |d| d.fpga().emissions().1.iter().any(|x| x.0 > 0));
                answer = format!("{{\"sounds\":{}}}", (0..units).any(on));
            }
            "drop" => drop(faults.drop_frames.insert(u, n)),
            "dropanswer" => drop(faults.drop_answers.insert(u, n)),
            "repeat" => drop(faults.repeat_frames.insert(u, n)),
            "mute" => drop(faults.muted.insert(u, n != 0)),
            "delay" => faults.delay_us = num(1),
            "quit" => break,
            _ => answer = String::from("{\"ok\":false}"),
        }
        println!("{answer}");
        std::io::stdout().flush()?;
    }
    std::process::exit(0);
}
