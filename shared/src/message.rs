//! One table per direction: explicit ids, names and bodies. Ids are append-only.

/// Defines an enum of messages with an explicit id each, and its encoding and decoding.
macro_rules! messages {
    (
        $(#[$enum_doc:meta])*
        pub enum $name:ident {
            $( $(#[doc = $doc:literal])+ $id:literal $variant:ident $(($body:ty))? , )+
        }
    ) => {
        $(#[$enum_doc])*
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub enum $name {
            $( $(#[doc = $doc])+ $variant $(($body))? , )+
        }

        impl $name {
            /// Every message: id, name, first line of its documentation, in the order of the ids.
            pub const TABLE: &'static [(u8, &'static str, &'static [&'static str])] =
                &[ $( ($id, stringify!($variant), &[$($doc),+]) ),+ ];

            /// The message's id on the wire.
            #[must_use]
            pub const fn id(&self) -> u8 {
                match self { $( messages!(@pattern $variant $(, $body)?) => $id, )+ }
            }

            /// Writes the body into `buffer` and returns its length in bytes.
            ///
            /// # Errors
            /// [`FrameError::TooLong`](crate::FrameError::TooLong) if `buffer` is too short.
            pub fn encode_body(&self, buffer: &mut [u8]) -> Result<usize, $crate::FrameError> {
                match self { $( messages!(@bind value $variant $(, $body)?) => {
                    messages!(@encode value buffer $(, $body)?)
                } )+ }
            }

            /// Reads a body; every byte of it must be used.
            ///
            /// # Errors
            /// [`Refusal::UnknownMessage`](crate::Refusal::UnknownMessage) for an id that is not in the table,
            /// [`Refusal::Malformed`](crate::Refusal::Malformed) for a body that is too short, too long or
            /// impossible.
            pub fn decode(id: u8, body: &[u8]) -> Result<Self, $crate::Refusal> {
                match id {
                    $( $id => messages!(@decode body $variant $(, $body)?), )+
                    id => Err($crate::Refusal::UnknownMessage { id }),
                }
            }
        }
    };
    (@pattern $variant:ident) => { Self::$variant };
    (@pattern $variant:ident, $body:ty) => { Self::$variant(_) };
    (@bind $value:ident $variant:ident) => { Self::$variant };
    (@bind $value:ident $variant:ident, $body:ty) => { Self::$variant($value) };
    (@encode $value:ident $buffer:ident) => { Ok(0) };
    (@encode $value:ident $buffer:ident, $body:ty) => {
        postcard::to_slice($value, $buffer).map(|used| used.len()).map_err(|_| $crate::FrameError::TooLong)
    };
    (@decode $bytes:ident $variant:ident) => {
        if $bytes.is_empty() { Ok(Self::$variant) } else { Err($crate::Refusal::Malformed) }
    };
    (@decode $bytes:ident $variant:ident, $body:ty) => {
        match postcard::take_from_bytes::<$body>($bytes) {
            Ok((body, [])) => Ok(Self::$variant(body)),
            _ => Err($crate::Refusal::Malformed),
        }
    };
}
pub(crate) use messages;
