!> Version of the package; the build system supplies the number as a macro.
module rwmf_core_version
   implicit none
   private

   public :: version

   character(*), parameter :: version = RWMF_VERSION
   !! version of the package's metadata, for example '1.2.3'

end module rwmf_core_version
