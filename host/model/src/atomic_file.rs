//! Files on disk. A write is atomic: the whole file or nothing. A read stops at a size limit.
//!
//! ```text
//! write(path) --> temporary file in the same folder --> sync --> the old file's permissions --> rename over path
//!                      |
//!                      +-- removed when writing fails (Drop), and by remove_unfinished when the program ends
//! ```

use crate::content::NOT_TEXT;
use slipline_plate::quantity::{Count, Counted, must_be};
use std::collections::BTreeMap;
use std::fs::{File, Metadata};
use std::io::{self, BufWriter, ErrorKind, Read, Seek as _, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{Builder, NamedTempFile};

/// The name of standard input or output on a command line.
pub const STANDARD_STREAM: &str = "-";

/// The files that are being written now, each with the name of its temporary file.
static UNFINISHED: Mutex<BTreeMap<PathBuf, PathBuf>> = Mutex::new(BTreeMap::new());

fn unfinished() -> MutexGuard<'static, BTreeMap<PathBuf, PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a file through `write`, into a temporary file first, so that the old file stays until the new one is
/// complete. The new file gets the permissions of the old one, or the system's default if there was none. For a
/// symbolic link, the link's target is replaced, not the link. A pipe or a device is written to directly.
///
/// # Errors
/// The error of the system or of `write`; the old file is then unchanged. [`ErrorKind::ResourceBusy`] when another
/// thread is writing the same file.
pub fn write<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    if is_stream(path) {
        return through(&File::create(path)?, write);
    }
    // A file that does not exist yet keeps the given path.
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let old = path.metadata().ok();
    let (part, _registration) = begin(&path, old.as_ref())?;
    through(part.as_file(), write)?;
    Ok(finish(part, old.as_ref(), &path)?)
}

/// As [`write()`], but an existing file is not replaced, even if another program creates it meanwhile; a link that leads to
/// no file counts as existing.
///
/// # Errors
/// As [`write()`], and [`ErrorKind::AlreadyExists`].
pub fn create<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    if is_stream(path) {
        return through(&File::create(path)?, write);
    }
    let (part, _registration) = begin(path, None)?;
    through(part.as_file(), write)?;
    part.as_file().sync_all()?;
    Ok(part.persist_noclobber(path).map(drop).map_err(|error| error.error)?)
}

/// Writes to a stream through `write`, into a temporary file first: `write` may go back in it, and where it fails nothing is
/// written.
///
/// # Errors
/// The error of the system or of `write`.
pub fn write_to<E: From<io::Error>>(
    stream: &mut impl Write,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    let mut part = tempfile::tempfile()?;
    through(&part, write)?;
    part.rewind()?;
    io::copy(&mut part, stream)?;
    Ok(stream.flush()?)
}

fn through<E: From<io::Error>>(
    file: &File,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    let mut out = BufWriter::new(file);
    write(&mut out)?;
    out.into_inner().map(drop).map_err(|error| E::from(error.into_error()))
}

/// Tries whether a file can be written there, without writing it: its folder must take a temporary file. A pipe or a
/// device is not tried.
///
/// # Errors
/// The error of the system, and [`ErrorKind::ResourceBusy`] as for [`write()`].
pub fn try_to_write(path: &Path) -> io::Result<()> {
    if is_stream(path) {
        return Ok(());
    }
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let (part, _registration) = begin(&path, None)?;
    part.close()
}

/// Marks a file as being written, until it is dropped.
struct Registration<'a>(&'a Path);

impl Drop for Registration<'_> {
    fn drop(&mut self) {
        unfinished().remove(self.0);
    }
}

/// A temporary file in the folder of `path`; it is removed on drop.
fn begin<'a>(path: &'a Path, old: Option<&Metadata>) -> io::Result<(NamedTempFile, Registration<'a>)> {
    let mut all = unfinished();
    if all.contains_key(path) {
        return Err(io::Error::new(ErrorKind::ResourceBusy, "it is being written already"));
    }
    let mut builder = Builder::new();
    builder.prefix(".slipline-").suffix(".part");
    #[cfg(unix)]
    if old.is_none() {
        use std::os::unix::fs::PermissionsExt as _;
        // The umask is subtracted from this mode, as for a new file of any program. If an old file is replaced,
        // only the owner may read the temporary file: its content may be private.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    #[cfg(not(unix))]
    let _ = old;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let part = builder.tempfile_in(folder)?;
    all.insert(path.to_owned(), part.path().to_owned());
    Ok((part, Registration(path)))
}

/// Renames the complete temporary file to its final name.
fn finish(part: NamedTempFile, old: Option<&Metadata>, path: &Path) -> io::Result<()> {
    if let Some(old) = old {
        part.as_file().set_permissions(old.permissions())?;
    }
    part.as_file().sync_all()?;
    part.persist(path).map(drop).map_err(|error| error.error)
}

/// Removes the temporary files of unfinished writes. Call it only when the program ends: afterwards no write can
/// begin.
pub fn remove_unfinished() {
    let all = unfinished();
    for part in all.values() {
        let _ = std::fs::remove_file(part);
    }
    // The lock is never released, so that no other thread begins a file.
    std::mem::forget(all);
}

/// Whether the path is a pipe or a device, which cannot be replaced by a rename. A folder counts, too: the system
/// refuses to write to it, and that error is the right one.
pub fn is_stream(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file())
}

/// Reads a text file of at most `most` bytes; a larger file is not read, and neither is a pipe or a device.
///
/// # Errors
/// [`ErrorKind::IsADirectory`] and [`ErrorKind::InvalidInput`] for anything but a regular file,
/// [`ErrorKind::FileTooLarge`] beyond `most` bytes, [`ErrorKind::InvalidData`] if it is not UTF-8 text, and
/// the errors of the system.
pub fn read_text(path: &Path, most: usize) -> io::Result<String> {
    read_bytes(path, most).and_then(text)
}

/// The text of these bytes.
///
/// # Errors
/// [`ErrorKind::InvalidData`] if they are not UTF-8 text.
pub fn text(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|_| io::Error::new(ErrorKind::InvalidData, NOT_TEXT))
}

/// Reads a file of at most `most` bytes; a larger file is not read.
///
/// # Errors
/// [`ErrorKind::FileTooLarge`] beyond `most` bytes, and the errors of the system.
pub fn read_bytes(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    // Checked before it is opened: opening a pipe blocks until another program writes to it, possibly without
    // end.
    let found = path.metadata()?;
    if found.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "is a directory: name a file in it"));
    }
    if !found.is_file() {
        let reason = "is a pipe or a device: save its output in a file and name that";
        return Err(io::Error::new(ErrorKind::InvalidInput, reason));
    }
    // The file may grow meanwhile, so the limit is applied while reading.
    read_limited(File::open(path)?, most)
}

/// Reads a stream of at most `most` bytes to its end.
///
/// # Errors
/// [`ErrorKind::FileTooLarge`] beyond `most` bytes, and the errors of the system.
pub fn read_limited(stream: impl Read, most: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Reading one byte more than allowed distinguishes a file that is too large from one that just fits.
    stream.take(most as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > most {
        let reason = must_be("the file is too big", Count::at_most(most, Counted::Bytes).with_unit());
        return Err(io::Error::new(ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// The message for a path whose folder does not exist.
pub fn missing_folder(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir())?;
    Some(format!("there is no folder {}", folder.display()))
}

pub use slipline_link::system_words as said;

#[cfg(test)]
mod tests {
    use super::*;

    /// An empty folder for one test.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("slipline-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn put(path: &Path, bytes: &[u8]) -> io::Result<()> {
        write(path, |out| out.write_all(bytes))
    }

    fn count(folder: &Path) -> usize {
        std::fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn a_file_is_whole_or_as_it_was() {
        let folder = folder("whole");
        let path = folder.join("a.txt");
        put(&path, b"old").unwrap();
        let half = write(&path, |out| {
            out.write_all(&[b'x'; 100_000])?;
            assert!(count(&folder) == 2 && std::fs::read(&path)? == b"old", "the old one stays");
            assert_eq!(put(&path, b"other").unwrap_err().kind(), ErrorKind::ResourceBusy);
            Err(io::Error::other("the disk is full"))
        });
        assert_eq!(half.unwrap_err().to_string(), "the disk is full");
        assert_eq!((count(&folder), std::fs::read(&path).unwrap()), (1, b"old".to_vec()));
        put(&path, b"new").unwrap();
        assert_eq!((count(&folder), std::fs::read(&path).unwrap()), (1, b"new".to_vec()));
        std::fs::create_dir(folder.join("taken")).unwrap();
        assert!(put(&folder.join("taken"), b"x").is_err());
        assert_eq!(count(&folder), 2, "no part is left behind");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn of_several_that_create_a_file_one_succeeds_and_the_others_leave_it() {
        let folder = folder("created");
        let path = folder.join("a.txt");
        let other = create(&path, |out| {
            // Another program is faster.
            std::fs::write(&path, b"theirs")?;
            out.write_all(b"ours")
        });
        assert_eq!(other.unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!((count(&folder), std::fs::read(&path).unwrap()), (1, b"theirs".to_vec()));
        std::fs::remove_file(&path).unwrap();
        create(&path, |out| out.write_all(b"ours")).unwrap();
        assert_eq!((count(&folder), std::fs::read(&path).unwrap()), (1, b"ours".to_vec()));
        #[cfg(unix)]
        {
            let link = folder.join("link");
            std::os::unix::fs::symlink(folder.join("nothing"), &link).unwrap();
            let refused = create(&link, |out| out.write_all(b"ours")).unwrap_err();
            assert_eq!((refused.kind(), link.is_symlink()), (ErrorKind::AlreadyExists, true));
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_stream_gets_the_whole_or_nothing_and_may_be_gone_back_in() {
        use std::io::{Seek as _, SeekFrom};
        let mut stream = Vec::new();
        write_to(&mut stream, |out| {
            out.write_all(b"????data")?;
            out.seek(SeekFrom::Start(0))?;
            out.write_all(b"RIFF")
        })
        .unwrap();
        assert_eq!(stream, b"RIFFdata");
        let half = write_to(&mut stream, |out| {
            out.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("no more"))
        });
        assert_eq!((half.unwrap_err().to_string(), stream.len()), ("no more".to_owned(), 8));
        assert_eq!(read_limited(&b"four"[..], 4).unwrap(), b"four");
        assert_eq!(read_limited(&b"fives"[..], 4).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    #[test]
    fn a_try_leaves_the_folder_as_it_was_and_fails_where_nothing_can_be_written() {
        let folder = folder("tried");
        let path = folder.join("a.txt");
        try_to_write(&path).unwrap();
        put(&path, b"old").unwrap();
        try_to_write(&path).unwrap();
        assert_eq!((count(&folder), std::fs::read(&path).unwrap()), (1, b"old".to_vec()));
        assert!(try_to_write(&folder.join("none").join("a.txt")).is_err());
        #[cfg(target_os = "linux")]
        assert!(try_to_write(Path::new("/proc/a.txt")).is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_is_replaced_keeps_its_permissions_and_a_new_one_has_the_usual_ones() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = folder("permissions");
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o7777;
        let path = folder.join("a.txt");
        for kept in [0o600, 0o640, 0o755, 0o666] {
            std::fs::write(&path, b"old").unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(kept)).unwrap();
            put(&path, b"new").unwrap();
            assert_eq!(mode(&path), kept, "{kept:o}");
        }
        let (usual, new) = (folder.join("usual.txt"), folder.join("new.txt"));
        std::fs::write(&usual, b"x").unwrap();
        put(&new, b"x").unwrap();
        assert_eq!(mode(&new), mode(&usual));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn what_only_the_owner_may_read_is_not_shown_while_it_is_written() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = folder("private");
        let path = folder.join("a.txt");
        put(&path, b"old").unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
        write(&path, |out| {
            out.write_all(b"new")?;
            for entry in std::fs::read_dir(&folder)? {
                let mode = entry?.metadata()?.permissions().mode();
                assert_eq!(mode & 0o077, 0, "{mode:o}");
            }
            io::Result::Ok(())
        })
        .unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn temporary_names_cannot_be_predicted() {
        let folder = folder("names");
        let path = folder.join("a.txt");
        let mut names = std::collections::BTreeSet::new();
        for _ in 0..3 {
            write(&path, |_| {
                let parts = std::fs::read_dir(&folder)?.filter_map(Result::ok).map(|entry| entry.file_name());
                names.extend(parts.filter(|name| name != "a.txt"));
                io::Result::Ok(())
            })
            .unwrap();
        }
        assert_eq!(names.len(), 3, "each write has a name of its own: {names:?}");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn what_a_link_leads_to_is_replaced_and_a_pipe_is_written_to() {
        let folder = folder("links");
        let (path, link, pipe) = (folder.join("a.txt"), folder.join("link"), folder.join("pipe"));
        put(&path, b"old").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        put(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || std::fs::read(pipe).unwrap()
        });
        put(&pipe, b"through").unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        assert!(is_stream(&pipe));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn huge_missing_and_binary_files_are_refused_in_words() {
        let folder = folder("read");
        let path = folder.join("a.toml");
        let refusal = |path: &Path| {
            let error = read_text(path, 10).unwrap_err();
            (error.kind(), said(&error))
        };
        assert_eq!(refusal(&path).0, ErrorKind::NotFound);
        assert_eq!(
            refusal(&folder),
            (ErrorKind::IsADirectory, "is a directory: name a file in it".to_owned())
        );
        let too_big = "the file is too big: must be at most 10 bytes";
        for (bytes, kind, reason) in [
            (&[b' '; 11][..], ErrorKind::FileTooLarge, too_big),
            (&[0xff, 0xfe], ErrorKind::InvalidData, "the file is not UTF-8 text"),
        ] {
            put(&path, bytes).unwrap();
            assert_eq!(refusal(&path), (kind, reason.to_owned()));
        }
        #[cfg(unix)]
        {
            let pipe = folder.join("pipe");
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            let reason = "is a pipe or a device: save its output in a file and name that";
            for path in [pipe.as_path(), Path::new("/dev/null")] {
                assert_eq!(refusal(path), (ErrorKind::InvalidInput, reason.to_owned()));
            }
        }
        put(&path, b"x = 1 # 10").unwrap();
        assert_eq!(read_text(&path, 10).unwrap(), "x = 1 # 10");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
