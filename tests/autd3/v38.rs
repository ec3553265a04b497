//! The server of the line 38 as its makers publish it, with a link whose units are the makers' emulated ones. They keep
//! their state from client to client, as real ones do. It prints lines of JSON: its port, and every --period-ms what each
//! unit sounds, before modulation. Options: --port P, --period-ms N, --bus-ms N, --skew-ms N, --ppm N, --clock monotonic.
use autd3_core::{
    ethercat::DcSysTime,
    firmware::Segment,
    geometry::Geometry,
    link::{Ack, AsyncLink, LinkError, RxMessage, TxBufferPoolSync, TxMessage},
};
use autd3_firmware_emulator::CPUEmulator;
use autd3_link_remote::RemoteServer;
use std::{
    cell::RefCell,
    fmt::Write as _,
    io::Write as _,
    rc::Rc,
    time::{Duration, Instant},
};

/// The makers' server binds 0.0.0.0; this keeps every listener of this program on 127.0.0.1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bind(fd: libc::c_int, addr: *const libc::sockaddr, len: libc::socklen_t) -> libc::c_int {
    unsafe {
        if !addr.is_null() && (*addr).sa_family as i32 == libc::AF_INET {
            let mut here = *(addr as *const libc::sockaddr_in);
            here.sin_addr.s_addr = u32::from_ne_bytes([127, 0, 0, 1]);
            return libc::syscall(libc::SYS_bind, fd, &here as *const _, len) as libc::c_int;
        }
        libc::syscall(libc::SYS_bind, fd, addr, len) as libc::c_int
    }
}

/// The units' clock: the machine's time, plus `--skew-ms`, plus `--ppm` since the start.
/// `--clock monotonic` instead is what the makers' EtherCrab link gives units on Linux: CLOCK_MONOTONIC minus 946684800 ns.
static SKEW: std::sync::OnceLock<(i64, f64, Instant, bool)> = std::sync::OnceLock::new();
fn dc_now() -> DcSysTime {
    let &(skew, ppm, begun, monotonic) = SKEW.get().unwrap();
    let off = skew + (ppm * 1e-6 * begun.elapsed().as_nanos() as f64) as i64;
    if monotonic {
        let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut t) };
        let ns = t.tv_sec as u64 * 1_000_000_000 + t.tv_nsec as u64;
        return DcSysTime::new(ns.saturating_sub(946684800).wrapping_add_signed(off));
    }
    DcSysTime::new(DcSysTime::now().sys_time().wrapping_add_signed(off))
}

fn hex(bytes: impl Iterator<Item = u8>) -> String {
    bytes.fold(String::new(), |mut out, b| {
        let _ = write!(out, "{b:02x}");
        out
    })
}

/// The widest pulse of a unit now, in ticks of 512 a period; 0 is silence.
fn widest(cpu: &CPUEmulator) -> u16 {
    let f = cpu.fpga();
    let m = f.modulation();
    f.drives().iter().map(|d| f.to_pulse_width(d.intensity, m).pulse_width().unwrap_or(u16::MAX)).max().unwrap_or(0)
}

/// The loudest intensity of the segment that does not sound: `other`.
fn unit(cpu: &CPUEmulator) -> String {
    let f = cpu.fpga();
    let d = f.drives();
    let s = f.current_stm_segment();
    let m = f.current_mod_segment();
    let other = if s == Segment::S0 { Segment::S1 } else { Segment::S0 };
    let loudest = (0..f.stm_cycle(other)).flat_map(|i| f.drives_at(other, i)).map(|d| d.intensity.0).max().unwrap_or(0);
    let steps = f.silencer_completion_steps();
    format!(
        "{{\"kind\":\"{}\",\"index\":{},\"size\":{},\"divider\":{},\"sound_speed\":{},\"sounding\":{},\"other\":{loudest},\
         \"phase\":\"{}\",\"intensity\":\"{}\",\
         \"modulation\":{{\"divider\":{},\"samples\":\"{}\"}},\"silencer\":[{},{}]}}",
        if f.is_stm_gain_mode(s) { "raw" } else { "foci" },
        f.current_stm_idx(),
        f.stm_cycle(s),
        f.stm_freq_divide(s),
        f.sound_speed(s),
        widest(cpu),
        hex(d.iter().map(|d| d.phase.0)),
        hex(d.iter().map(|d| d.intensity.0)),
        f.modulation_freq_divide(m),
        hex(f.modulation_buffer(m).into_iter()),
        steps.intensity,
        steps.phase,
    )
}

struct Units {
    cpus: Vec<CPUEmulator>,
    begun: Instant,
    bus: Duration,
    messages: u64,
    errors: u64,
}

impl Units {
    fn update(&mut self) {
        let now = dc_now();
        for c in &mut self.cpus {
            c.update_with_sys_time(now);
        }
    }
    fn say(&mut self) {
        self.update();
        let units = self.cpus.iter().map(unit).collect::<Vec<_>>().join(",");
        println!(
            "{{\"t\":{:.6},\"dc\":{},\"messages\":{},\"errors\":{},\"units\":[{units}]}}",
            self.begun.elapsed().as_secs_f64(),
            dc_now().sys_time(),
            self.messages,
            self.errors
        );
        let _ = std::io::stdout().flush();
    }
}

struct Wrapped {
    units: Rc<RefCell<Units>>,
    pool: TxBufferPoolSync,
    open: bool,
    pending: Option<(Instant, Vec<TxMessage>)>,
}

impl Wrapped {
    /// Hands the messages that wait to the units, if the bus has had its cycle.
    fn deliver(&mut self, wait: bool) {
        let due = self.pending.as_ref().is_some_and(|(at, _)| wait || Instant::now() >= *at);
        if !due {
            return;
        }
        let (_, tx) = self.pending.take().unwrap();
        let mut u = self.units.borrow_mut();
        u.update();
        for c in &mut u.cpus {
            c.send(&tx);
        }
        u.update();
        u.messages += 1;
        u.errors += u.cpus.iter().filter(|c| c.rx().ack().err() != 0).count() as u64;
        drop(u);
        self.pool.return_buffer(tx);
    }
}

impl AsyncLink for Wrapped {
    async fn open(&mut self, geometry: &Geometry) -> Result<(), LinkError> {
        self.pool.init(geometry);
        let mut u = self.units.borrow_mut();
        if u.cpus.len() != geometry.len() {
            u.cpus = geometry.iter().map(|d| CPUEmulator::new(d.idx(), d.num_transducers())).collect();
        }
        self.open = true;
        Ok(())
    }

    async fn close(&mut self) -> Result<(), LinkError> {
        self.deliver(true);
        self.open = false;
        Ok(())
    }

    async fn update(&mut self, _: &Geometry) -> Result<(), LinkError> {
        Ok(())
    }

    async fn alloc_tx_buffer(&mut self) -> Result<Vec<TxMessage>, LinkError> {
        self.deliver(true);
        Ok(self.pool.borrow())
    }

    async fn send(&mut self, tx: Vec<TxMessage>) -> Result<(), LinkError> {
        let bus = self.units.borrow().bus;
        let at = if bus.is_zero() {
            Instant::now()
        } else {
            // the next cycle of the bus
            let begun = self.units.borrow().begun;
            let cycles = begun.elapsed().as_nanos() / bus.as_nanos() + 1;
            begun + bus * cycles as u32
        };
        self.pending = Some((at, tx));
        self.deliver(bus.is_zero());
        Ok(())
    }

    async fn receive(&mut self, rx: &mut [RxMessage]) -> Result<(), LinkError> {
        self.deliver(false);
        let mut u = self.units.borrow_mut();
        u.update();
        for (r, c) in rx.iter_mut().zip(&u.cpus) {
            *r = if self.pending.is_some() { RxMessage::new(c.rx().data(), Ack::new(c.rx().ack().msg_id(), c.rx().ack().err())) } else { c.rx() };
        }
        Ok(())
    }

    fn is_open(&self) -> bool {
        self.open
    }

    fn ensure_is_open(&self) -> Result<(), LinkError> {
        if self.open { Ok(()) } else { Err(LinkError::closed()) }
    }
}

fn value(name: &str) -> Option<String> {
    let args: Vec<String> = std::env::args().collect();
    args.iter().position(|a| a == name).and_then(|i| args.get(i + 1)).cloned()
}

fn number(name: &str, usual: f64) -> f64 {
    value(name).map_or(usual, |v| v.parse().expect("a number"))
}

pub fn run() {
    let port = number("--port", 8080.0) as u16;
    let monotonic = value("--clock").as_deref() == Some("monotonic");
    let _ = SKEW.set(((number("--skew-ms", 0.0) * 1e6) as i64, number("--ppm", 0.0), Instant::now(), monotonic));
    let period = Duration::from_secs_f64(number("--period-ms", 20.0) / 1e3);
    let units = Rc::new(RefCell::new(Units {
        cpus: Vec::new(),
        begun: Instant::now(),
        bus: Duration::from_secs_f64(number("--bus-ms", 1.0) / 1e3),
        messages: 0,
        errors: 0,
    }));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let local = units.clone();
    let mut server = RemoteServer::new(port, move || Wrapped {
        units: local.clone(),
        pool: TxBufferPoolSync::default(),
        open: false,
        pending: None,
    });
    println!("{{\"address\":\"127.0.0.1:{port}\"}}");
    let _ = std::io::stdout().flush();
    runtime.block_on(async move {
        let samples = async {
            loop {
                tokio::time::sleep(period).await;
                units.borrow_mut().say();
            }
        };
        tokio::select! {
            r = server.run() => eprintln!("the server ended: {r:?}"),
            _ = samples => {},
        }
    });
}
