!> Formats of files that are no records of this reader, known by their first bytes.
module rwmf_input_record_formats
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_input_record_lines, only: known_formats
   use rwmf_text_strings, only: next_line, to_lower
   implicit none
   private

   public :: check_format

   integer, parameter :: head = 1000
   !! bytes that are inspected
   integer, parameter :: longest_name = 40
   character(*), parameter :: as_columns = 'two columns of time [s] and acceleration'

contains

   !> Refuse a file of another format by its name.
   subroutine check_format(bytes, error)
      character(*), intent(in) :: bytes
      !! the whole file
      type(error_t), allocatable, intent(out) :: error
      character(longest_name) :: name
      character(head) :: line

      if (len(bytes) == 0) then
         call fail(error, err_input, 'the file is empty')
         return
      end if
      name = archive(bytes)
      if (name /= '') then
         call fail(error, err_input, 'is '//trim(name)//': extract the record from it')
         return
      end if
      if (index(bytes(:min(len(bytes), head)), achar(0)) > 0) then
         call fail(error, err_input, 'is a binary file: records are text; other programs convert ' &
            //'miniSEED or SAC to '//as_columns)
         return
      end if
      name = unread_format(bytes)
      if (name /= '') then
         call fail(error, err_input, 'the format '//trim(name)//' is not read: write '// &
            as_columns//'; '//known_formats)
         return
      end if
      ! name of a format that Python reads as channels, '' for none
      line = first_line(bytes)
      name = ''
      if (index(line, 'event_name:') == 1) name = 'ESM'
      if (index(line, 'origin time') == 1) name = 'K-NET'
      if (index(line, '#k-net') == 1 .or. index(line, '#kik-net') == 1) name = 'K-NET CSV'
      if (index(line, '(format v') > 0 .and. index(line, 'acceleration') > 0) name = 'COSMOS'
      if (index(line, 'uncorrected accelerogram data') == 1) name = 'CGS'
      if (index(line, 'corrected accelerogram ') == 1) name = 'CGS'
      line = to_lower(bytes(:min(len(bytes), head)))
      if (index(line, 'corrected acceleration ') > 0 .and. index(line, 'unit:') > 0) name = 'CSMNC'
      if (name /= '') call fail(error, err_input, 'the file has the format '//trim(name) &
         //", which the command 'rwmf records convert' writes as columns for &motion")
   end subroutine check_format

   !> Kind of an archive or document, '' for none.
   pure function archive(bytes) result(name)
      character(*), intent(in) :: bytes
      character(longest_name) :: name

      name = ''
      if (index(bytes, 'PK'//achar(3)//achar(4)) == 1) name = 'a zip archive'
      if (index(bytes, 'PK'//achar(5)//achar(6)) == 1) name = 'a zip archive'
      if (index(bytes, achar(31)//char(139)) == 1) name = 'a gzip archive'
      if (index(bytes, 'BZh') == 1) name = 'a bzip2 archive'
      if (index(bytes, '7z'//char(188)//char(175)) == 1) name = 'a 7z archive'
      if (index(bytes, char(253)//'7zXZ') == 1) name = 'an xz archive'
      if (index(bytes, 'Rar!') == 1) name = 'a rar archive'
      if (index(bytes, char(255)//char(254)) == 1) name = 'a text in UTF-16, not UTF-8'
      if (index(bytes, char(254)//char(255)) == 1) name = 'a text in UTF-16, not UTF-8'
      if (index(bytes, char(208)//char(207)//char(17)//char(224)) == 1) name = 'an Excel file'
      if (index(bytes, char(137)//'HDF') == 1) name = 'an HDF5 file'
      if (index(bytes, '%PDF') == 1) name = 'a PDF file'
      if (index(bytes, '<') == 1) name = 'an HTML or XML file'
   end function archive

   !> Name of a format that nothing here reads, '' for none.
   pure function unread_format(bytes) result(name)
      character(*), intent(in) :: bytes
      character(longest_name) :: name
      character(head) :: line
      character(*), parameter :: smc(7) = [character(24) :: 'unknown', 'uncorrected accelerogram', &
         'corrected accelerogram', 'velocity', 'displacement', 'response spectra', 'fourier']
      integer :: i
      logical :: is_cosmos, is_of_gns

      line = adjustl(first_line(bytes))
      name = ''
      if (scan(line, '0123456789*') == 1) then
         do i = 1, size(smc)
            if (index(adjustl(line(2:)), trim(smc(i))) == 1) name = 'SMC (USGS)'
         end do
      end if
      if (index(line, 'strong ground motion records of t') == 1) name = 'AFAD (Turkey)'
      is_of_gns = index(line, 'gns') > 0 .or. index(line, 'geological and nuc') > 0
      if (index(line, 'corrected accelerogram ') > 0 .and. is_of_gns) name = 'GeoNet (New Zealand)'
      if (index(line, 'geonet') > 0) name = 'GeoNet (New Zealand)'
      if (index(line, 'response and fourier amplitude') == 1) name = 'CSMIP volume 3 (spectra)'
      if (index(line, '#earthquake information') == 1 .or. index(line, '# earthquake information') &
         == 1 .or. index(line, '#stationcode') == 1) name = 'CWB (Taiwan)'
      is_cosmos = index(line, '(format v') > 0
      if (is_cosmos .and. index(line, 'acceleration') == 0) name = 'COSMOS without accelerations'
      line = to_lower(bytes(:min(len(bytes), head)))
      if (index(line, 'archivo estandar de aceleracion') > 0) name = 'UNAM/ASA (Mexico)'
   end function unread_format

   pure function first_line(bytes) result(line)
      character(*), intent(in) :: bytes
      character(head) :: line
      integer :: first
      integer :: last
      integer :: position

      position = 1
      line = ''
      if (len(bytes) == 0) return
      call next_line(bytes, position, first, last)
      line = to_lower(bytes(first:min(last, first + head - 1)))
   end function first_line

end module rwmf_input_record_formats
